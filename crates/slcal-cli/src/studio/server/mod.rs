//! The server: pages, sessions, state and pictures over HTTP and a WebSocket.

pub(super) mod access;
mod answer;
mod connections;
pub(super) mod hub;
pub(super) mod links;
mod pages;
mod routes;
mod session;
mod socket;
mod told;

use std::net::TcpListener;
use std::sync::Arc;
use std::time::Duration;

use self::hub::Hub;

/// Time passes in steps of this length.
const TICK: Duration = Duration::from_millis(50);

/// Serves until the process ends.
pub(super) fn serve(hub: &Arc<Hub>, listener: TcpListener) -> std::io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    runtime.block_on(async {
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        tokio::spawn(connections::serve(listener, routes::router(hub.clone())));
        let mut interval = tokio::time::interval(TICK);
        interval.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        loop {
            interval.tick().await;
            hub.tick();
        }
    })
}
