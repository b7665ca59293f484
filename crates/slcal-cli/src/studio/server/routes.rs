//! What is answered under which address.

use std::io::Cursor;
use std::sync::Arc;

use axum::Router;
use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, Response, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::IntoResponse;
use axum::routing::{get, post};
use image::imageops::FilterType;
use image::{DynamicImage, RgbImage};
use serde::Deserialize;
use serde_json::{Value, json};
use slcal_core::format::{CloudFormat, read_ply};

use super::access::{Role, check_origin};
use super::answer::{Refusal, bytes, download, report, secured};
use super::hub::Hub;
use super::session::{Answer, Asked, role};
use super::{pages, socket};
use crate::cloud_view::packed;
use crate::io::{
    Foreign, InputKind, decode_photo, extension_of, input_name, jpeg_bytes, png_bytes, read_bytes,
};
use crate::studio::machine::Machine;
use crate::studio::project::{Purpose, cloud_name};
use crate::studio::words::command;
use crate::studio::worker;

/// Largest upload, bytes.
const MOST_BYTES: usize = 50 << 20;
/// Largest JSON body, bytes.
const MOST_JSON: usize = 64 << 10;
/// Longer side of photographs as pages show them, px.
const SHOWN_PX: u32 = 1280;
const SMALLEST_PX: u32 = 64;
/// Quality of pictures that pages show: nothing is measured in them.
const SHOWN_QUALITY: u8 = 85;

type Shared = State<Arc<Hub>>;

pub(super) fn router(hub: Arc<Hub>) -> Router {
    Router::new()
        .route("/", get(|| async { page("index.html") }))
        .route("/display", get(|| async { page("display.html") }))
        .route("/camera", get(|| async { page("camera.html") }))
        .route("/web/{name}", get(|Path(name): Path<String>| async move { page(&name) }))
        .route("/ws", get(socket::upgrade))
        .route("/report", get(rig_report))
        .route("/api/session", post(session))
        .route("/api/state", get(state))
        .route("/api/shown.png", get(shown))
        .route("/api/live.jpg", get(live))
        .route("/api/photographs/{name}", get(photograph))
        .route("/api/photographs", post(upload))
        .route("/api/scans/{name}", get(scan))
        .route("/api/clouds/{name}", get(cloud))
        .route("/api/cloud/live", get(live_cloud))
        .route("/api/exports/{format}", get(export))
        .route("/api/painted", post(painted))
        .route("/api/picture", post(picture))
        .fallback(|| async { Refusal::missing("such page") })
        .layer(from_fn_with_state(hub.clone(), guard))
        .with_state(hub)
}

/// Before every request: is it for this server, and from its own pages? After it: what all answers carry.
async fn guard(State(hub): Shared, request: Request, next: Next) -> Response<Body> {
    let checked = {
        let access = hub.access();
        let headers = request.headers();
        let reads = [Method::GET, Method::HEAD].contains(request.method());
        // A connection carries events.
        let changes = !reads || request.uri().path() == "/ws";
        access.check_host(headers).and_then(|()| if changes { check_origin(headers) } else { Ok(()) })
    };
    secured(match checked {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    })
}

fn page(name: &str) -> Answer {
    let (kind, content) = pages::file(name).ok_or_else(|| Refusal::missing("such page"))?;
    Ok(bytes(kind, content.to_vec()))
}

/// Those who see everything.
const SEEING: [Role; 3] = [Role::Operator, Role::Watcher, Role::Display];

async fn body(request: Request, most: usize) -> Result<Bytes, Refusal> {
    let too_large = || {
        Refusal::new(
            StatusCode::PAYLOAD_TOO_LARGE,
            "too-large",
            format!("expected a file of at most {} MB", most >> 20),
            "send the photograph as a JPEG, or put it into the folder of --watch, where it may be larger",
        )
    };
    let length =
        request.headers().get(header::CONTENT_LENGTH).and_then(|l| l.to_str().ok()?.parse::<u64>().ok());
    if length.is_some_and(|l| l > most as u64) {
        return Err(too_large());
    }
    to_bytes(request.into_body(), most).await.map_err(|_| too_large())
}

#[derive(Deserialize)]
struct TokenSent {
    token: String,
}

async fn session(State(hub): Shared, request: Request) -> Answer {
    let sent = body(request, MOST_JSON).await?;
    let malformed = |_| {
        Refusal::new(StatusCode::BAD_REQUEST, "malformed", "expected {\"token\": \"...\"}", "reload the page")
    };
    let TokenSent { token } = serde_json::from_slice(&sent).map_err(malformed)?;
    let (role, cookie) = hub.access().open(&token)?;
    let mut answer = bytes("application/json", json!({ "role": role }).to_string().into_bytes());
    if let Ok(cookie) = HeaderValue::from_str(&cookie) {
        answer.headers_mut().insert(header::SET_COOKIE, cookie);
    }
    Ok(answer)
}

async fn state(State(hub): Shared, headers: HeaderMap, Query(asked): Query<Asked>) -> Answer {
    let role = role(&hub, &headers, &asked, &Role::ALL)?;
    Ok(json_answer(&hub.told(role, None)))
}

fn json_answer(value: &Value) -> Response<Body> {
    bytes("application/json", value.to_string().into_bytes())
}

/// Decodes photographs, few at a time.
async fn decoding<T: Send + 'static>(
    hub: &Arc<Hub>,
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    // An error means that it was closed, which it never is.
    let _turn = hub.decoding.acquire().await;
    aside(work).await
}

/// Does work that takes time away from the threads of the server.
async fn aside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let failed =
        |_| Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, "failed", "the work was not done", "try again");
    tokio::task::spawn_blocking(work).await.map_err(failed)?
}

async fn shown(State(hub): Shared, headers: HeaderMap, Query(asked): Query<Asked>) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    if let Some((pattern, frame)) = hub.with(Machine::wanted_frame) {
        let drawn = move || {
            let picture = pattern.image(frame).ok();
            picture.and_then(|p| png_bytes(&DynamicImage::ImageLuma8(p)).ok()).ok_or_else(not_shown)
        };
        return Ok(bytes("image/png", aside(drawn).await?));
    }
    let name = hub.with(|m| m.state.display.wanted.kind.file());
    let name = name.ok_or_else(not_shown)?;
    let read = move || hub.project.read(name).map_err(|_| not_shown());
    Ok(bytes("image/png", aside(read).await?))
}

fn not_shown() -> Refusal {
    Refusal::missing("picture on the display")
}

async fn live(State(hub): Shared, headers: HeaderMap, Query(asked): Query<Asked>) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    let frame = hub.pictures.live().ok_or_else(|| Refusal::missing("live picture"))?;
    let encoded = aside(move || shown_jpeg(&frame)).await?;
    Ok(bytes("image/jpeg", encoded))
}

async fn photograph(
    State(hub): Shared,
    headers: HeaderMap,
    Path(name): Path<String>,
    Query(asked): Query<Asked>,
) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    stored_picture(hub, Purpose::Sheet, &name, asked.width).await
}

async fn scan(
    State(hub): Shared,
    headers: HeaderMap,
    Path(name): Path<String>,
    Query(asked): Query<Asked>,
) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    stored_picture(hub, Purpose::Scan, &name, asked.width).await
}

/// The number before an ending: of `3.jpg`.
fn number(name: &str, ending: &str) -> Option<u32> {
    let digits = name.strip_suffix(ending)?;
    digits.parse().ok().filter(|_| digits.bytes().all(|b| b.is_ascii_digit()))
}

/// A photograph encoded anew, without what the camera wrote beside it.
async fn stored_picture(hub: Arc<Hub>, purpose: Purpose, name: &str, width: Option<u32>) -> Answer {
    let missing = || Refusal::missing("such photograph");
    let id = number(name, ".jpg").ok_or_else(missing)?;
    let longest = width.map_or(SHOWN_PX, |w| w.clamp(SMALLEST_PX, SHOWN_PX));
    let project = hub.project.clone();
    let encoded = decoding(&hub, move || {
        let photo = project.photos(purpose).into_iter().find(|p| p.id == id);
        let path = photo.map(|photo| project.path(&photo.name));
        let of_sequence = || project.picture_of_scan(id).filter(|_| purpose == Purpose::Scan);
        let path = path.or_else(of_sequence).ok_or_else(missing)?;
        let file = read_bytes(&path, InputKind::Own).map_err(|_| missing())?;
        let picture = decode_photo(&file, &input_name(&path)).map_err(|_| missing())?.photo;
        shown_jpeg(&smaller(picture, longest))
    });
    Ok(bytes("image/jpeg", encoded.await?))
}

fn shown_jpeg(picture: &RgbImage) -> Result<Vec<u8>, Refusal> {
    jpeg_bytes(picture, SHOWN_QUALITY).map_err(|_| Refusal::missing("picture that can be shown"))
}

fn smaller(picture: DynamicImage, longest: u32) -> RgbImage {
    if picture.width().max(picture.height()) <= longest {
        return picture.into_rgb8();
    }
    picture.resize(longest, longest, FilterType::Triangle).into_rgb8()
}

async fn cloud(
    State(hub): Shared,
    headers: HeaderMap,
    Path(name): Path<String>,
    Query(asked): Query<Asked>,
) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    let missing = || Refusal::missing("such cloud");
    let (digits, ending) = name.split_once('.').map_or((name.as_str(), None), |(d, e)| (d, Some(e)));
    let id = number(digits, "").ok_or_else(missing)?;
    let format = ending.map(|e| e.parse::<CloudFormat>().map_err(|_| missing())).transpose()?;
    aside(move || {
        let file = hub.project.read(&cloud_name(id, "ply")).map_err(|_| missing())?;
        let cloud = || read_ply(file.as_slice()).map_err(|_| missing());
        Ok(match format {
            None => bytes("application/octet-stream", packed(&cloud()?)),
            Some(CloudFormat::Ply) => download(&cloud_name(id, "ply"), file),
            Some(format) => {
                let mut converted = Vec::new();
                format.write(&cloud()?, &mut converted).map_err(|_| missing())?;
                download(&cloud_name(id, format.name()), converted)
            }
        })
    })
    .await
}

async fn live_cloud(State(hub): Shared, headers: HeaderMap, Query(asked): Query<Asked>) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    let cloud = hub.live_cloud().ok_or_else(|| Refusal::missing("cloud of a continuous scan"))?;
    Ok(bytes("application/octet-stream", cloud.to_vec()))
}

async fn rig_report(State(hub): Shared, headers: HeaderMap, Query(asked): Query<Asked>) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    let (rig, command) = hub.with(|m| (m.rig.clone(), command(&m.state)));
    let rig = rig.ok_or_else(|| Refusal::missing("calibration yet"))?;
    let project = hub.project.clone();
    let page = decoding(&hub, move || Ok(worker::report(&project, &rig, command)));
    Ok(report(page.await?))
}

/// A file that was written for another program.
async fn export(
    State(hub): Shared,
    headers: HeaderMap,
    Path(format): Path<String>,
    Query(asked): Query<Asked>,
) -> Answer {
    role(&hub, &headers, &asked, &SEEING)?;
    let rig = hub.with(|m| m.rig.clone()).ok_or_else(|| Refusal::missing("calibration yet"))?;
    let write = move || worker::exported(&rig, &format).map_err(|_| Refusal::missing("such format"));
    let exported = aside(write).await?;
    match <[_; 1]>::try_from(exported) {
        Ok([file]) => Ok(download(file.name, file.bytes)),
        Err(several) => Err(Refusal::new(
            StatusCode::CONFLICT,
            "export-several-files",
            format!("this format has {} files", several.len()),
            "they lie in the project's folder after Export",
        )),
    }
}

async fn upload(
    State(hub): Shared,
    headers: HeaderMap,
    Query(asked): Query<Asked>,
    request: Request,
) -> Answer {
    role(&hub, &headers, &asked, &[Role::Operator, Role::Camera])?;
    operates(&hub, &asked)?;
    let purpose = hub.purpose(asked.shot).map_err(|problem| Refusal::of(&problem))?;
    let sent = body(request, MOST_BYTES).await?;
    let extension = extension_of(&sent).ok_or_else(|| not_a_picture("a photograph", &sent))?;
    let name = asked.name.unwrap_or_default();
    let photo = decoding(&hub, {
        let hub = hub.clone();
        move || {
            // What cannot be decoded is not kept.
            decode_photo(&sent, &shown_name(&name, extension)).map_err(|failure| {
                Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, "not-a-photograph", failure.to_string(), "")
            })?;
            hub.project.keep(purpose, &sent, extension).map_err(|failure| {
                Refusal::new(
                    StatusCode::INSUFFICIENT_STORAGE,
                    "not-kept",
                    failure.to_string(),
                    "make room on the disk",
                )
            })
        }
    })
    .await?;
    let answer = json!({ "id": photo.id, "scan": purpose != Purpose::Sheet });
    hub.kept(purpose, photo);
    Ok(json_answer(&answer))
}

/// A page that says its number must be the one that operates.
fn operates(hub: &Hub, asked: &Asked) -> Result<(), Refusal> {
    asked.page.map_or(Ok(()), |page| hub.check_operates(page)).map_err(|problem| Refusal::of(&problem))
}

/// `what` was expected to be there: a photograph, or a picture to project.
fn not_a_picture(what: &str, sent: &[u8]) -> Refusal {
    let foreign = Foreign::of(sent, "");
    Refusal::new(
        StatusCode::UNSUPPORTED_MEDIA_TYPE,
        "not-a-picture",
        format!(
            "expected {what} (JPEG, PNG, TIFF, WebP or BMP), found {}",
            foreign.map_or("something else", Foreign::found)
        ),
        foreign.map_or("send it as the camera or program wrote it", Foreign::advice),
    )
}

/// The name of an upload for messages only: it never becomes a path. A long one is shortened in its middle.
fn shown_name(name: &str, extension: &str) -> String {
    const LONGEST: usize = 60;
    let plain: Vec<char> = name.chars().filter(|c| !c.is_control()).collect();
    if plain.is_empty() {
        return format!("photograph.{extension}");
    }
    if plain.len() <= LONGEST {
        return plain.into_iter().collect();
    }
    let (first, last) = (&plain[..LONGEST / 2], &plain[plain.len() - LONGEST / 2..]);
    first.iter().chain(&['…']).chain(last).collect()
}

/// What the display page painted: the simulated camera sees it.
async fn painted(
    State(hub): Shared,
    headers: HeaderMap,
    Query(asked): Query<Asked>,
    request: Request,
) -> Answer {
    role(&hub, &headers, &asked, &[Role::Display])?;
    if !hub.with(|m| m.state.demo) {
        return Err(Refusal::missing("simulated camera"));
    }
    let sent = body(request, MOST_BYTES).await?;
    let panel = hub.with(|m| m.state.set_up.projector);
    let picture = decoding(&hub, move || {
        image::ImageReader::with_format(Cursor::new(&sent[..]), image::ImageFormat::Png)
            .decode()
            .map(|p| p.to_rgb8())
            .map_err(|_| not_a_picture("a photograph", &sent))
    })
    .await?;
    if panel != Some([picture.width(), picture.height()]) {
        return Err(Refusal::new(
            StatusCode::UNPROCESSABLE_ENTITY,
            "painted-size",
            "expected a picture of the panel's size",
            "reload the display page",
        ));
    }
    hub.pictures.paint(picture);
    Ok(json_answer(&json!({})))
}

/// A picture to project without keystone.
async fn picture(
    State(hub): Shared,
    headers: HeaderMap,
    Query(asked): Query<Asked>,
    request: Request,
) -> Answer {
    role(&hub, &headers, &asked, &[Role::Operator])?;
    operates(&hub, &asked)?;
    let sent = body(request, MOST_BYTES).await?;
    let extension = extension_of(&sent).ok_or_else(|| not_a_picture("a picture to project", &sent))?;
    let name = shown_name(asked.name.as_deref().unwrap_or_default(), extension);
    hub.project_picture(name, sent.to_vec().into()).map_err(|problem| Refusal::of(&problem))?;
    Ok(json_answer(&json!({})))
}
