//! The connection of a page: the state and live messages to it, events from it.

use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::ws::{Message as Frame, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, State};
use axum::http::{HeaderMap, Response};
use image::RgbImage;
use serde_json::json;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{Instant, interval, timeout};

use super::access::Role;
use super::hub::{Hub, Message};
use super::session::{Answer, Asked, role};
use crate::io::decode_photo;
use crate::studio::event::{DisplayEvent, OperatorEvent};

/// Largest message, bytes: a live frame.
const MOST_BYTES: usize = 50 << 20;
/// Bytes before the JPEG of a live frame.
const FRAME_HEAD: usize = 8;
/// A page is asked this often whether it is still there, and is taken for gone after the longer time without a word.
const PING: Duration = Duration::from_secs(20);
const GONE: Duration = Duration::from_secs(65);

pub(super) async fn upgrade(
    State(hub): State<Arc<Hub>>,
    headers: HeaderMap,
    Query(asked): Query<Asked>,
    socket: WebSocketUpgrade,
) -> Answer {
    let role = role(&hub, &headers, &asked, &Role::ALL)?;
    let upgraded: Response<Body> = socket
        .max_message_size(MOST_BYTES)
        .max_frame_size(MOST_BYTES)
        .on_upgrade(move |socket| serve(hub, socket, role));
    Ok(upgraded)
}

/// Until the page leaves.
async fn serve(hub: Arc<Hub>, mut socket: WebSocket, role: Role) {
    let (mut changes, mut messages) = (hub.watch(), hub.listen());
    let id = hub.connect(role);
    let mut told = tell(&hub, &mut socket, role, id).await;
    let (mut pings, mut heard) = (interval(PING), Instant::now());
    while told {
        told = tokio::select! {
            changed = changes.changed() => changed.is_ok() && tell(&hub, &mut socket, role, id).await,
            message = messages.recv() => pass_on(&hub, &mut socket, message, role, id).await,
            frame = socket.recv() => match frame {
                Some(Ok(frame)) => {
                    heard = Instant::now();
                    take(&hub, &mut socket, frame, role, id).await
                }
                _ => false,
            },
            _ = pings.tick() => {
                heard.elapsed() < GONE && put(&mut socket, Frame::Ping(Bytes::new())).await
            }
        };
    }
    hub.disconnect(id);
}

async fn tell(hub: &Hub, socket: &mut WebSocket, role: Role, id: u64) -> bool {
    let state = json!({ "type": "state", "state": hub.told(role, Some(id)) });
    send(socket, state.to_string()).await
}

async fn send(socket: &mut WebSocket, text: String) -> bool {
    put(socket, Frame::Text(text.into())).await
}

/// Whether the page took it; one that has vanished takes nothing and says nothing.
async fn put(socket: &mut WebSocket, frame: Frame) -> bool {
    timeout(GONE, socket.send(frame)).await.is_ok_and(|sent| sent.is_ok())
}

async fn pass_on(
    hub: &Hub,
    socket: &mut WebSocket,
    message: Result<Message, RecvError>,
    role: Role,
    id: u64,
) -> bool {
    match message {
        Ok(Message::Live(text)) if matches!(role, Role::Operator | Role::Watcher) => {
            send(socket, text.to_string()).await
        }
        Ok(Message::Shoot(text)) if role == Role::Operator && hub.operates(id) => {
            send(socket, text.to_string()).await
        }
        // A slow page misses live messages; the state comes whole.
        Ok(_) | Err(RecvError::Lagged(_)) => true,
        Err(RecvError::Closed) => false,
    }
}

async fn take(hub: &Hub, socket: &mut WebSocket, frame: Frame, role: Role, id: u64) -> bool {
    let refused = match (frame, role) {
        (Frame::Text(text), Role::Operator) => match serde_json::from_str::<OperatorEvent>(&text) {
            Ok(event) => hub.operate(id, event).err().map(|problem| json!(problem)),
            Err(error) => Some(malformed(&error)),
        },
        (Frame::Text(text), Role::Display) => match serde_json::from_str::<DisplayEvent>(&text) {
            Ok(event) => {
                hub.display(event);
                None
            }
            Err(error) => Some(malformed(&error)),
        },
        (Frame::Binary(bytes), Role::Operator) => {
            if hub.operates(id)
                && let Some((seq, picture)) = decoded(bytes).await
            {
                hub.frame(id, seq, picture);
            }
            None
        }
        (Frame::Close(_), _) => return false,
        _ => None,
    };
    match refused {
        Some(problem) => {
            let message = json!({ "type": "refused", "message": problem["message"], "problem": problem });
            send(socket, message.to_string()).await
        }
        None => true,
    }
}

/// Number and picture of a live frame. It is decoded here, while the worker is at the frame before.
async fn decoded(frame: Bytes) -> Option<(u32, Arc<RgbImage>)> {
    let decode = move || {
        let seq = u32::from_le_bytes(*frame.first_chunk::<4>()?);
        let photo = decode_photo(frame.get(FRAME_HEAD..)?, "live frame").ok()?.photo;
        Some((seq, Arc::new(photo.into_rgb8())))
    };
    // What cannot be decoded is no frame.
    tokio::task::spawn_blocking(decode).await.ok().flatten()
}

fn malformed(error: &serde_json::Error) -> serde_json::Value {
    json!({ "code": "malformed", "message": format!("the event is not understood: {error}"), "advice": "reload the page" })
}
