//! Which role a request has.

use axum::body::Body;
use axum::http::{HeaderMap, Response, StatusCode};
use serde::Deserialize;

use super::access::Role;
use super::answer::Refusal;
use super::hub::Hub;

pub(super) type Answer = Result<Response<Body>, Refusal>;

/// What stands in the query of an address.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asked {
    #[serde(rename = "as")]
    pub(super) role: Option<Role>,
    pub(super) name: Option<String>,
    pub(super) width: Option<u32>,
    /// The shot that a photograph answers.
    pub(super) shot: Option<u64>,
    /// The number of the page that asks, as its state tells it.
    pub(super) page: Option<u64>,
}

/// The role that a request has: the one it states, or the first that its cookies hold.
pub(super) fn role(hub: &Hub, headers: &HeaderMap, asked: &Asked, allowed: &[Role]) -> Result<Role, Refusal> {
    let access = hub.access();
    let has = |role: &&Role| access.has(headers, **role);
    let found = match &asked.role {
        Some(role) => Some(role).filter(has),
        None => Role::ALL.iter().find(|r| has(r) && allowed.contains(r)),
    };
    let found = found.ok_or_else(|| {
        Refusal::new(
            StatusCode::FORBIDDEN,
            "session-missing",
            "this page has no session",
            "open the address that slcal studio printed",
        )
    })?;
    if !allowed.contains(found) {
        return Err(Refusal::new(
            StatusCode::FORBIDDEN,
            "role-other",
            "this page may not do that",
            "use the operator's page",
        ));
    }
    Ok(*found)
}
