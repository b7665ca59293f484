//! Who may do what: tokens, sessions, and requests from elsewhere.

use std::collections::HashMap;
use std::net::{IpAddr, SocketAddr};

use axum::http::{HeaderMap, StatusCode, header};
use serde::{Deserialize, Serialize};

use super::answer::Refusal;

/// Bytes of a token: 128 bits.
const TOKEN_BYTES: usize = 16;
/// Sessions that are kept: the oldest of more are forgotten.
const MOST_SESSIONS: usize = 1000;

/// What a page may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::studio) enum Role {
    /// Everything, one at a time.
    Operator,
    /// Shows pictures.
    Display,
    /// Uploads photographs.
    Camera,
    /// Sees.
    Watcher,
}

impl Role {
    pub(in crate::studio) const ALL: [Self; 4] = [Self::Operator, Self::Display, Self::Camera, Self::Watcher];

    /// Its name in addresses and cookies.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Operator => "operator",
            Self::Display => "display",
            Self::Camera => "camera",
            Self::Watcher => "watcher",
        }
    }
}

/// A secret that nobody guesses.
pub(in crate::studio) fn secret() -> Result<String, getrandom::Error> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes)?;
    let digit = |value: u8| char::from_digit(value.into(), 16).unwrap_or('0');
    Ok(bytes.iter().flat_map(|b| [digit(b >> 4), digit(b & 15)]).collect())
}

/// The tokens of the roles, and the sessions that were opened with them.
#[derive(Debug)]
pub(in crate::studio) struct Access {
    tokens: [(Role, String); 4],
    sessions: HashMap<String, (Role, u64)>,
    opened: u64,
    /// Hosts under which this server is known, with the port.
    hosts: Vec<String>,
    port: u16,
}

impl Access {
    /// With new tokens, for a server at this address and those of the network.
    pub(in crate::studio) fn new(at: SocketAddr, others: &[IpAddr]) -> Result<Self, getrandom::Error> {
        let port = at.port();
        let mut hosts: Vec<String> =
            ["127.0.0.1", "localhost", "[::1]"].iter().map(|host| format!("{host}:{port}")).collect();
        hosts.extend(others.iter().map(|ip| SocketAddr::new(*ip, port).to_string()));
        let mut tokens = Role::ALL.map(|role| (role, String::new()));
        for (_, token) in &mut tokens {
            *token = secret()?;
        }
        Ok(Self { tokens, sessions: HashMap::new(), opened: 0, hosts, port })
    }

    pub(in crate::studio) fn token(&self, role: Role) -> &str {
        self.tokens.iter().find(|(r, _)| *r == role).map_or("", |(_, token)| token)
    }

    /// Opens a session for a token: its role and the cookie.
    pub(super) fn open(&mut self, token: &str) -> Result<(Role, String), Refusal> {
        let role = self.tokens.iter().find(|(_, t)| equal(t, token)).map(|(role, _)| *role);
        let wrong = || {
            Refusal::new(
                StatusCode::FORBIDDEN,
                "token-wrong",
                "this address is of another run of slcal studio",
                "open the address that slcal studio printed last",
            )
        };
        let role = role.ok_or_else(wrong)?;
        let secret = secret().map_err(|_| wrong())?;
        if self.sessions.len() >= MOST_SESSIONS
            && let Some(oldest) = self.sessions.iter().min_by_key(|(_, (_, n))| *n).map(|(k, _)| k.clone())
        {
            self.sessions.remove(&oldest);
        }
        self.opened += 1;
        self.sessions.insert(secret.clone(), (role, self.opened));
        let cookie = format!("{}={secret}; Path=/; HttpOnly; SameSite=Strict", self.cookie_name(role));
        Ok((role, cookie))
    }

    /// Whether the request's cookies hold a session of this role.
    pub(super) fn has(&self, headers: &HeaderMap, role: Role) -> bool {
        let name = self.cookie_name(role);
        let cookies = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
        cookies
            .flat_map(|line| line.split(';'))
            .filter_map(|pair| pair.trim().split_once('='))
            .any(|(n, value)| n == name && self.sessions.get(value).is_some_and(|(r, _)| *r == role))
    }

    /// Cookies do not know ports: the name does.
    fn cookie_name(&self, role: Role) -> String {
        format!("slcal-{}-{}", self.port, role.name())
    }

    /// Refuses requests under a name that is not this server's (DNS rebinding).
    pub(super) fn check_host(&self, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = headers.get(header::HOST).and_then(|h| h.to_str().ok()).unwrap_or_default();
        if self.hosts.iter().any(|known| known.eq_ignore_ascii_case(host)) {
            return Ok(());
        }
        Err(Refusal::new(
            StatusCode::FORBIDDEN,
            "host-unknown",
            "the request is for another host",
            "open the address that slcal studio printed",
        ))
    }
}

/// Refuses requests that change something and come from pages of others, or do not say where they come from.
pub(super) fn check_origin(headers: &HeaderMap) -> Result<(), Refusal> {
    let host = headers.get(header::HOST).and_then(|h| h.to_str().ok()).unwrap_or_default();
    let origin = headers.get(header::ORIGIN).and_then(|o| o.to_str().ok()).unwrap_or_default();
    if origin.strip_prefix("http://").is_some_and(|of| of.eq_ignore_ascii_case(host)) {
        return Ok(());
    }
    Err(Refusal::new(
        StatusCode::FORBIDDEN,
        "origin-foreign",
        "the request comes from another page",
        "use the pages of slcal studio",
    ))
}

/// Compares in a time that does not tell how many characters agree.
fn equal(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differ, (x, y)| differ | (x ^ y)) == 0
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    fn access() -> Access {
        Access::new("127.0.0.1:8642".parse().unwrap(), &["192.168.0.5".parse().unwrap()]).unwrap()
    }

    fn headers(all: &[(header::HeaderName, &str)]) -> HeaderMap {
        all.iter().map(|(name, value)| (name.clone(), HeaderValue::from_str(value).unwrap())).collect()
    }

    #[test]
    fn tokens_are_long_and_differ() {
        let access = access();
        let tokens: std::collections::HashSet<_> = Role::ALL.map(|r| access.token(r).to_owned()).into();
        assert!(tokens.len() == 4 && tokens.iter().all(|t| t.len() == 32));
    }

    #[test]
    fn a_session_is_of_its_role_alone() {
        let mut access = access();
        let token = access.token(Role::Display).to_owned();
        let (role, cookie) = access.open(&token).unwrap();
        assert!(role == Role::Display && cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"));
        let sent = headers(&[(header::COOKIE, cookie.split(';').next().unwrap())]);
        assert!(access.has(&sent, Role::Display) && !access.has(&sent, Role::Operator));
        assert!(!access.has(&HeaderMap::new(), Role::Display));
        // The same secret under another role's name.
        let forged = cookie.split(';').next().unwrap().replace("display", "operator");
        assert!(!access.has(&headers(&[(header::COOKIE, &forged)]), Role::Operator));
        for wrong in ["", "0123", &"0".repeat(32)] {
            assert_eq!(access.open(wrong).unwrap_err().code, "token-wrong");
        }
    }

    #[test]
    fn other_hosts_and_origins_are_refused() {
        let access = access();
        let host = |h| access.check_host(&headers(&[(header::HOST, h)])).is_ok();
        assert!(host("127.0.0.1:8642") && host("localhost:8642") && host("192.168.0.5:8642"));
        assert!(!host("127.0.0.1") && !host("evil.example:8642") && !host("127.0.0.1:8643"));
        let origin = |o: &str| {
            check_origin(&headers(&[(header::HOST, "localhost:8642"), (header::ORIGIN, o)])).is_ok()
        };
        assert!(origin("http://localhost:8642"));
        assert!(!origin("http://evil.example") && !origin("null") && !origin("http://127.0.0.1:8642"));
        assert!(check_origin(&headers(&[(header::HOST, "localhost:8642")])).is_err());
    }
}
