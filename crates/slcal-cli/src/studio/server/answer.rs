//! What the server answers: files, JSON, refusals.

use axum::body::Body;
use axum::http::{HeaderValue, Response, StatusCode, header};
use axum::response::IntoResponse;
use serde_json::json;

/// What pages may do: nothing but talk to this server.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
                      media-src 'self' blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A request that is not done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::studio) struct Refusal {
    status: StatusCode,
    pub(super) code: &'static str,
    message: String,
    advice: String,
}

impl Refusal {
    pub(super) fn new(
        status: StatusCode,
        code: &'static str,
        message: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self { status, code, message: message.into(), advice: advice.into() }
    }

    /// For what is not there.
    pub(super) fn missing(what: &str) -> Self {
        Self::new(StatusCode::NOT_FOUND, "not-found", format!("there is no {what}"), "")
    }

    /// For what the state does not allow.
    pub(super) fn of(problem: &super::super::state::Problem) -> Self {
        Self::new(StatusCode::CONFLICT, problem.code, &problem.message, &problem.advice)
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response<Body> {
        let error = json!({ "error": { "code": self.code, "message": self.message, "advice": self.advice } });
        with_status(self.status, bytes("application/json", error.to_string().into_bytes()))
    }
}

fn with_status(status: StatusCode, mut response: Response<Body>) -> Response<Body> {
    *response.status_mut() = status;
    response
}

/// Bytes of a kind; nothing is stored by caches.
pub(super) fn bytes(kind: &'static str, body: Vec<u8>) -> Response<Body> {
    let mut response = Response::new(Body::from(body));
    response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}

/// The same as a download with a name of ours.
pub(super) fn download(name: &str, body: Vec<u8>) -> Response<Body> {
    let mut response = bytes("application/octet-stream", body);
    if let Ok(value) = HeaderValue::from_str(&format!("attachment; filename=\"{name}\"")) {
        response.headers_mut().insert(header::CONTENT_DISPOSITION, value);
    }
    response
}

/// A report: it has scripts of its own, so it is kept apart from the server's pages and cookies.
pub(super) fn report(body: Vec<u8>) -> Response<Body> {
    let mut response = bytes("text/html; charset=utf-8", body);
    let policy = HeaderValue::from_static("sandbox allow-scripts; frame-ancestors 'none'");
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
    response
}

/// What all answers carry.
pub(super) fn secured(mut response: Response<Body>) -> Response<Body> {
    let headers = response.headers_mut();
    headers.entry(header::CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(POLICY));
    for (name, value) in [
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::CACHE_CONTROL, "no-store"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response.headers_mut().insert("cross-origin-opener-policy", HeaderValue::from_static("same-origin"));
    response.headers_mut().insert("cross-origin-resource-policy", HeaderValue::from_static("same-origin"));
    response
}
