//! Connections: their number is limited, for each address too, and a request's head must come in time.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

/// Connections at a time; more wait until one ends. macOS gives a process 256 open files, unless it is asked for more.
const MOST: usize = 192;
/// Connections at a time from one address; more are closed. A browser opens six for each page.
const MOST_PER_ADDRESS: usize = 64;
/// A connection that has not sent the whole head of a request after this time is closed, one that is idle too.
const HEAD: Duration = Duration::from_secs(10);
/// The pause after the system refused a connection, as it does when files are used up.
const PAUSE: Duration = Duration::from_millis(100);

/// Accepts connections until the process ends. WebSockets are not counted: only a page that has a role opens one, and `socket` sees to them.
pub(super) async fn serve(listener: TcpListener, router: Router) -> ! {
    let places = Arc::new(Semaphore::new(MOST));
    let guests = Guests::default();
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEAD);
    loop {
        let place = places.clone().acquire_owned().await;
        let Ok((stream, peer)) = listener.accept().await else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        let Some(guest) = guests.enter(peer.ip()) else { continue };
        let service = TowerToHyperService::new(router.clone());
        let connection = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
        tokio::spawn(async move {
            // Its errors are the other side's: it left, or sent no HTTP.
            let _ = connection.await;
            drop((guest, place));
        });
    }
}

/// How many connections each address has.
#[derive(Default, Clone)]
struct Guests(Arc<Mutex<HashMap<IpAddr, usize>>>);

/// One connection of an address, until it is dropped.
struct Guest {
    guests: Guests,
    address: IpAddr,
}

impl Guests {
    /// Counts a connection; `None` where its address has as many as it may.
    fn enter(&self, address: IpAddr) -> Option<Guest> {
        // A network of IPv6 gives a machine as many addresses as it wants.
        let address = match address.to_canonical() {
            IpAddr::V6(six) => IpAddr::V6((six.to_bits() & !u128::from(u64::MAX)).into()),
            IpAddr::V4(four) => IpAddr::V4(four),
        };
        let mut guests = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let count = guests.entry(address).or_default();
        if *count >= MOST_PER_ADDRESS {
            return None;
        }
        *count += 1;
        Some(Guest { guests: self.clone(), address })
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        let mut guests = self.guests.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = guests.get_mut(&self.address) {
            *count -= 1;
            if *count == 0 {
                guests.remove(&self.address);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_its_own_places_and_leaves_none_behind() {
        let guests = Guests::default();
        let address = |text: &str| text.parse::<IpAddr>().unwrap();
        let first: Vec<_> =
            (0..MOST_PER_ADDRESS).map(|_| guests.enter(address("10.0.0.1")).unwrap()).collect();
        assert!(
            guests.enter(address("10.0.0.1")).is_none() && guests.enter(address("::ffff:10.0.0.1")).is_none()
        );
        let other = guests.enter(address("10.0.0.2"));
        assert!(other.is_some());
        drop(first);
        assert!(guests.enter(address("10.0.0.1")).is_some());
        drop(other);
        assert!(guests.0.lock().unwrap().is_empty());
        let network: Vec<_> = (0..MOST_PER_ADDRESS)
            .map(|i| guests.enter(address(&format!("2001:db8::{i:x}"))).unwrap())
            .collect();
        assert!(guests.enter(address("2001:db8::ffff:1")).is_none());
        assert!(guests.enter(address("2001:db8:0:1::1")).is_some());
        drop(network);
    }
}
