//! The picture of a calibration: the detections in the photographs, and their residuals once there is a rig.

use std::path::Path;

use image::DynamicImage;
use image::imageops::FilterType;
use slcal_core::detect::Detection;
use slcal_core::{Calibration, Calibrator, Quality, Rig, ViewResiduals};

use crate::exit::{Failure, Outcome};
use crate::io::{input_name, png_bytes};
use crate::name::{name_among, short};
use crate::picture::Drawing;
use crate::picture::contact_sheet::{self, Tile};
use crate::picture::residual_drawing::{self, MeasuredView};
use crate::picture::sheet::{self, Partly};

/// The photographs to draw on.
pub(super) struct Gallery {
    /// How many there will be.
    expected: usize,
    shots: Vec<Shot>,
}

struct Shot {
    name: String,
    /// As taken, px.
    size: [u32; 2],
    /// In its size in the picture.
    photo: DynamicImage,
    seen: Seen,
}

enum Seen {
    All(Box<Detection>),
    Not { why: String, partly: Partly },
}

impl Gallery {
    pub(super) fn new(expected: usize) -> Self {
        Self { expected, shots: Vec::new() }
    }

    /// Adds a photograph in display encoding; `partly` is what can be drawn when not everything was found.
    pub(super) fn add(
        &mut self,
        path: &Path,
        photo: DynamicImage,
        found: Result<&Detection, &Failure>,
        partly: Partly,
    ) {
        let size = [photo.width(), photo.height()];
        let seen = match found {
            Ok(found) => Seen::All(Box::new(found.clone())),
            Err(why) => Seen::Not { why: why.to_string(), partly },
        };
        let photo = shown(photo, size, self.expected);
        self.shots.push(Shot { name: input_name(path), size, photo, seen });
    }

    /// Turns the photographs that the calibrator has turned, and takes over what it found in them.
    pub(super) fn turn(&mut self, calibrator: &Calibrator) {
        let turned = calibrator.quarter_turns().zip(calibrator.detections());
        for (shot, (quarters, found)) in self.shots.iter_mut().zip(turned).filter(|(_, (q, _))| *q != 0) {
            shot.photo = match quarters {
                1 => shot.photo.rotate90(),
                2 => shot.photo.rotate180(),
                _ => shot.photo.rotate270(),
            };
            if quarters % 2 == 1 {
                shot.size.swap(0, 1);
            }
            shot.photo = shown(std::mem::take(&mut shot.photo), shot.size, self.expected);
            shot.seen = Seen::All(Box::new(found.clone()));
        }
    }

    /// The photographs, as they were added.
    pub(super) fn photos(&self) -> impl Iterator<Item = &DynamicImage> {
        self.shots.iter().map(|s| &s.photo)
    }

    /// The picture as PNG, `None` without photographs; `misses` are the residuals, `failed` is why there is no rig.
    pub(super) fn picture(
        &self,
        calibrated: Option<&Calibration>,
        misses: &[ViewResiduals],
        failed: Option<&Failure>,
    ) -> Outcome<Option<Vec<u8>>> {
        let fits = calibrated.map_or_else(Vec::new, |c| fits(c, misses));
        let picture = match self.shots.as_slice() {
            [] => return Ok(None),
            [one] => one.drawing(fits.first().copied(), calibrated, failed).over(&one.photo)?,
            all => sheet_of(all, self.expected, &fits, calibrated, failed)?,
        };
        png_bytes(&picture).map(Some)
    }
}

/// A photograph as taken in this size, in its size in a picture of so many: a single one keeps all of its pixels, memory holds
/// small copies of many.
fn shown(photo: DynamicImage, size: [u32; 2], expected: usize) -> DynamicImage {
    let ([w, h], _) = contact_sheet::tile_size(size, expected);
    if expected > 1 && [w, h] != [photo.width(), photo.height()] {
        photo.resize_exact(w, h, FilterType::Triangle)
    } else {
        photo
    }
}

/// Views with their observations and residuals; none when their numbers differ.
fn fits<'a>(c: &'a Calibration, misses: &'a [ViewResiduals]) -> Vec<MeasuredView<'a>> {
    let views = c.rig.views.iter().zip(&c.observations.views).zip(misses);
    let camera = &c.rig.camera.model;
    views.map(|((view, observed), residuals)| MeasuredView { observed, residuals, view, camera }).collect()
}

impl Shot {
    /// The only photograph, with a legend.
    fn drawing(
        &self,
        fit: Option<MeasuredView<'_>>,
        calibrated: Option<&Calibration>,
        failed: Option<&Failure>,
    ) -> Drawing {
        let mut drawing = match (&self.seen, fit.zip(calibrated)) {
            (Seen::All(_), Some((fit, c))) => {
                let title = format!("{}: {}; {}", short(&self.name), verdict(&c.rig), fit.in_words());
                residual_drawing::drawing(self.size, &self.name, title.trim_end_matches([';', ' ']), fit)
            }
            (Seen::All(found), None) => sheet::found(self.size, &self.name, found),
            (Seen::Not { why, partly }, _) => sheet::not_found(self.size, &self.name, why, partly),
        };
        if let (Seen::All(_), Some(why)) = (&self.seen, failed) {
            drawing.legend =
                drawing.legend.map(|l| l.note(format!("not calibrated: {}", self.without_name(why))));
        }
        drawing
    }

    /// A message without the name of the file, which is in the headline.
    fn without_name(&self, why: &Failure) -> String {
        let why = why.to_string();
        why.strip_prefix(&format!("{}: ", self.name)).map_or_else(|| why.clone(), str::to_owned)
    }

    /// Without a legend, for a sheet of many.
    fn tile(&self, name: &str, fit: Option<MeasuredView<'_>>, factor: f64, coarseness: f64) -> Outcome<Tile> {
        let mut drawing = Drawing::new(self.size, &*self.name).coarser(coarseness);
        let mut odd = None;
        let mut caption = vec![name.to_owned()];
        match (&self.seen, fit) {
            (Seen::All(_), Some(fit)) => {
                residual_drawing::draw(&mut drawing, fit, factor);
                caption.extend(Some(fit.in_words()).filter(|t| !t.is_empty()));
                if fit.outliers() > 0 {
                    caption.push(format!("{} of {} points are outliers", fit.outliers(), fit.count()));
                }
                odd = fit.odd_in_words();
            }
            (Seen::All(found), None) => {
                sheet::draw_view(&mut drawing, &found.observation);
                caption.push(sheet::found_in_words(found));
            }
            (Seen::Not { partly, .. }, _) => {
                sheet::draw_partly(&mut drawing, partly);
                odd = Some("not everything was found".to_owned());
            }
        }
        Ok(Tile { picture: drawing.over(&self.photo)?, caption, odd })
    }
}

/// How good the calibration is, as a part of a headline.
fn verdict(rig: &Rig) -> String {
    let name = |q: &Quality| format!("a {} calibration", q.verdict.name());
    rig.quality.as_ref().map_or_else(|| "calibrated".to_owned(), name)
}

/// All photographs on one sheet.
fn sheet_of(
    shots: &[Shot],
    expected: usize,
    fits: &[MeasuredView<'_>],
    calibrated: Option<&Calibration>,
    failed: Option<&Failure>,
) -> Outcome<DynamicImage> {
    let (_, coarseness) = contact_sheet::tile_size(shots[0].size, expected);
    let like = Drawing::new(shots[0].size, "").coarser(coarseness);
    let factor = residual_drawing::enlargement(fits.iter().copied(), like.unit());
    let names: Vec<&str> = shots.iter().map(|s| &*s.name).collect();
    let tiles = shots
        .iter()
        .enumerate()
        .map(|(i, shot)| shot.tile(name_among(&names, i), fits.get(i).copied(), factor, coarseness))
        .collect::<Outcome<Vec<_>>>()?;
    let shown_as = f64::from(shots[0].photo.width()) / f64::from(shots[0].size[0]);
    let mut legend = match calibrated {
        Some(c) if !fits.is_empty() => {
            let title = format!("{} photographs: {}", shots.len(), verdict(&c.rig));
            let legend = residual_drawing::legend(
                &like,
                title.trim_end_matches([';', ' ', ':']),
                fits.iter().copied(),
                factor,
            );
            legend.with_bars(shown_as)
        }
        _ => {
            let found = shots.iter().filter_map(|s| match &s.seen {
                Seen::All(found) => Some(&found.observation),
                Seen::Not { partly: Partly::Sheet(view), .. } => Some(view.as_ref()),
                Seen::Not { .. } => None,
            });
            sheet::legend(format!("{} of {expected} photographs were processed", shots.len()), found)
        }
    };
    let why = shots.iter().find_map(|s| match &s.seen {
        Seen::Not { why, .. } => {
            let bare = why.strip_prefix(&format!("{}: ", s.name)).unwrap_or(why);
            Some(format!("{}: {bare}", short(&s.name)))
        }
        Seen::All(_) => None,
    });
    if let Some(why) = why.or_else(|| failed.map(|f| format!("not calibrated: {f}"))) {
        legend = legend.note(why);
    }
    contact_sheet::sheet(&tiles, "the photographs of a calibration", &legend)
}
