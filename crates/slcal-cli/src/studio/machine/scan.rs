//! The step Scan: clouds.

use std::sync::Arc;

use super::state_machine::{Effect, Machine};
use crate::studio::event::ScanMode;
use crate::studio::job::Job;
use crate::studio::project::{Purpose, StoredPhoto};
use crate::studio::scan_folder::ScanFolder;
use crate::studio::state::{CameraKind, CloudEntry, LIVE_LONGEST_PX, LiveCloud, Problem, ScanMethod, Step};
use crate::studio::words::command;

/// Weight of the newest interval in the rate of clouds.
const RATE_WEIGHT: f64 = 0.2;

impl Machine {
    pub(super) fn scan(&mut self, mode: ScanMode) -> Result<Vec<Effect>, Problem> {
        match mode {
            ScanMode::Once if self.state.scan.method != ScanMethod::Stripes => self.start_sequence(),
            ScanMode::Once => self.take(Purpose::Scan),
            ScanMode::Start => {
                self.need(Step::Scan)?;
                if self.state.scan.method != ScanMethod::Stripes {
                    return Err(Problem::new(
                        "continuous-sequence",
                        "a sequence takes many photographs of what does not move",
                        "scan once, or choose the stripes",
                    ));
                }
                if !matches!(self.state.camera.kind, Some(CameraKind::Webcam | CameraKind::Demo)) {
                    return Err(Problem::new(
                        "camera-not-live",
                        "this camera has no live picture",
                        "take single photographs, or choose a webcam",
                    ));
                }
                self.state.scan.continuous = true;
                self.state.scan.fps = 0.0;
                self.state.camera.live_longest_px = 0;
                self.last_cloud_ms = None;
                Ok(Vec::new())
            }
            ScanMode::Stop => Ok(self.end_scan()),
        }
    }

    /// Ends a continuous scan, whose last cloud is kept, or a sequence.
    pub(super) fn end_scan(&mut self) -> Vec<Effect> {
        self.stop_sequence(None);
        let scanned = self.state.scan.continuous && self.state.scan.live.is_some();
        self.stop_scanning();
        if scanned { vec![Effect::Work(Job::KeepLive)] } else { Vec::new() }
    }

    /// What needs the camera ends, and its delay is not known any more.
    pub(super) fn camera_gone(&mut self) {
        self.stop_scanning();
        (self.delay, self.state.camera.latency_ms) = (None, None);
        let why = "the camera is gone: the sequence is not complete";
        self.stop_sequence(Some(Problem::new("scan-interrupted", why, "start the camera, and scan again")));
    }

    pub(super) fn stop_scanning(&mut self) {
        self.state.scan.continuous = false;
        self.state.scan.live = None;
        self.state.camera.live_longest_px = LIVE_LONGEST_PX;
    }

    pub(super) fn live_cloud(&mut self, points: usize, bytes: Arc<[u8]>, now_ms: u64) -> Vec<Effect> {
        let scan = &mut self.state.scan;
        if !scan.continuous {
            return Vec::new();
        }
        if let Some(last) = self.last_cloud_ms {
            let rate = 1000.0 / now_ms.saturating_sub(last).max(1) as f64;
            scan.fps = if scan.fps > 0.0 { scan.fps + RATE_WEIGHT * (rate - scan.fps) } else { rate };
        }
        self.last_cloud_ms = Some(now_ms);
        let sequence = scan.live.as_ref().map_or(1, |l| l.sequence + 1);
        scan.live = Some(LiveCloud { sequence, points, url: format!("/api/cloud/live?sequence={sequence}") });
        vec![Effect::LiveCloud { sequence, bytes }]
    }

    /// Makes a cloud again from its photograph.
    pub(super) fn reconstruct(&mut self, id: u32) -> Result<Vec<Effect>, Problem> {
        self.need(Step::Scan)?;
        let cloud = self.state.scan.clouds.iter().find(|c| c.id == id);
        let cloud = cloud.ok_or_else(|| Problem::new("no-cloud", "there is no such cloud", ""))?;
        self.not_while_shooting()?;
        let name = cloud.photo_name.clone();
        let job = match cloud.frames {
            Some(_) => Job::SequenceCloud(ScanFolder { id, name }),
            None => Job::Cloud(StoredPhoto { id, name }),
        };
        self.state.busy = Some("reconstructing");
        Ok(vec![Effect::Work(job)])
    }

    /// Marks the clouds that were made with another rig than that of now.
    pub(super) fn compare_clouds(&mut self) {
        for cloud in &mut self.state.scan.clouds {
            cloud.outdated = cloud.rig != self.fingerprint;
        }
    }

    pub(super) fn cloud(&mut self, entry: CloudEntry) -> Vec<Effect> {
        self.state.scan.clouds.retain(|c| c.id != entry.id);
        self.state.scan.clouds.push(entry);
        // Made again, it keeps its place.
        self.state.scan.clouds.sort_by_key(|c| c.id);
        self.compare_clouds();
        if self.beginning || self.sequence.is_some() {
            return Vec::new();
        }
        self.state.busy = None;
        command(&self.state).filter(|_| self.state.step == Step::Scan).map(Effect::Log).into_iter().collect()
    }
}
