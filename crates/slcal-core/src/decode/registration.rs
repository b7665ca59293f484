//! Registration of the colour channels: stripes are put where green light would show them.

use super::config::{ChannelShift, ScanDirection};
use super::hue_shift::{Centres, HueShares, HueShift};
use super::labeling::VotedLabel;
use super::scanlines::ScanlineReader;
use super::slit_layout::SlitLayout;
use super::stripe_centers::{self, StripeCenter};
use super::tracks::Tracks;
use super::zigzag::{self, Located, Zigzag, ZigzagWork};
use crate::channel_registration::ChannelRegistration;
use crate::pattern::StripePattern;
use nalgebra::Matrix3;

/// Displacements that a photograph shows by itself, or a calibration, are removed beyond this many σ.
const SIGNIFICANT: f64 = 3.0;

/// Keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Registration {
    shares: HueShares,
    work: ZigzagWork,
    displacements: Vec<f32>,
}

/// Labelled stripes.
pub(super) struct Labelled<'a> {
    pub(super) tracks: &'a mut Tracks,
    pub(super) votes: &'a [VotedLabel],
    pub(super) layout: &'a SlitLayout,
    /// Hues of the slits in the order of a scanline.
    pub(super) slits: &'a [u8],
    pub(super) reversed: bool,
    pub(super) pattern: &'a StripePattern,
}

impl Labelled<'_> {
    /// Where the slit of a label is on the panel, projector px.
    fn panel(&self, label: usize) -> f32 {
        let slit = if self.reversed { self.slits.len() - 1 - label } else { label };
        self.pattern.centres_px[slit] as f32
    }

    fn locate(&self, scratch: &mut Vec<f32>, centers: &mut Vec<StripeCenter>) {
        stripe_centers::locate(self.tracks, self.votes, self.layout, scratch, centers);
    }
}

impl Registration {
    /// Locates the centres of the stripes as green light would show them, into `centers`. `known` comes from a calibration;
    /// `directions` and `mixing` are the measured colours of the hues. Returns what was found.
    pub(super) fn locate(
        &mut self,
        mut of: Labelled<'_>,
        reader: &ScanlineReader<'_>,
        known: Option<&ChannelRegistration>,
        (directions, mixing): (&[[f32; 3]], Option<&Matrix3<f64>>),
        scratch: &mut Vec<f32>,
        centers: &mut Vec<StripeCenter>,
    ) -> Option<ChannelShift> {
        // What a calibration could not tell from nothing would only add its error.
        let known = known.filter(|r| r.exceeds(SIGNIFICANT));
        self.shares.set(directions, mixing);
        let size = match reader.scan {
            ScanDirection::Rows => [reader.length(), reader.count()],
            ScanDirection::Columns => [reader.count(), reader.length()],
        };
        let centres = Centres::new(known, size, of.pattern, reader.scan);
        let before = known.map(|r| HueShift::of(r, of.pattern.axis, of.reversed, mixing));
        if let Some(shift) = before {
            self.remove(&mut of, &centres, &Zigzag { shift, ..Zigzag::default() });
        }
        of.locate(scratch, centers);
        let located = Located {
            tracks: of.tracks,
            votes: of.votes,
            centers,
            layout: of.layout,
            slits: of.slits,
            shares: &self.shares,
            centres: &centres,
        };
        let found = zigzag::measure(located, known.is_some(), &mut self.work);
        let significant = found.as_ref().is_some_and(|z| {
            let shifts = z.shift.panel_px.iter().zip(z.sigma_px);
            let radial = z.shift.radial.iter().zip(z.sigma_radial);
            shifts.chain(radial).any(|(x, sigma)| f64::from(x.abs()) > SIGNIFICANT * sigma)
        });
        let used = known.is_some() || significant;
        if let Some(found) = found.as_ref().filter(|_| used) {
            self.remove(&mut of, &centres, found);
            of.locate(scratch, centers);
        }
        let found = found?;
        let all = |part: &dyn Fn(&HueShift) -> f32| {
            f64::from(before.as_ref().map_or(0.0, part) + part(&found.shift))
        };
        let sign = if of.reversed { -1.0 } else { 1.0 };
        let [red_px, blue_px] = [0, 1].map(|k| all(&|shift| sign * shift.panel_px[k]));
        let radial = [0, 1].map(|k| all(&|shift| shift.radial[k]));
        Some(ChannelShift { red_px, blue_px, sigma_px: found.sigma_px, radial, used })
    }

    /// Moves the edges of all labelled stripes back.
    fn remove(&mut self, of: &mut Labelled<'_>, centres: &Centres, found: &Zigzag) {
        let Labelled { votes, layout, slits, .. } = *of;
        let tracks = &*of.tracks;
        let Self { shares, displacements, .. } = self;
        displacements.clear();
        displacements.resize(tracks.crossings.len(), 0.0);
        for y in 0..tracks.line_count() {
            let line = tracks.of(y);
            for i in line.clone() {
                let label = usize::from(votes[i].label);
                let Some(hue) = slits.get(label).map(|h| usize::from(*h)) else { continue };
                let (Some(&primaries), Some(&channels)) =
                    (shares.primaries.get(hue), shares.channels.get(hue))
                else {
                    continue;
                };
                let own = tracks.crossings[i];
                let beside = (i > line.start && i + 1 < line.end).then(|| [i - 1, i + 1]).filter(|[a, b]| {
                    usize::from(votes[*a].label) + 1 == label && usize::from(votes[*b].label) == label + 1
                });
                let scale = match beside.map(|pair| pair.map(|j| tracks.crossings[j].middle())) {
                    Some([a, b]) => (b - a) / (layout.gap_px(label, 0) + layout.gap_px(label, 1)),
                    None => 0.5 * own.width() / layout.half_px(),
                };
                let [along, across] = centres.image;
                let place = [own.middle() - along, y as f32 - across];
                let slope = tracks.slope(i);
                let offset = found.offsets_px.get(hue).copied().unwrap_or(0.0);
                displacements[i] = scale * offset
                    + found.shift.displacement(
                        [primaries, channels],
                        place,
                        slope,
                        of.panel(label) - centres.panel,
                        scale,
                    );
            }
        }
        for (crossing, px) in of.tracks.crossings.iter_mut().zip(displacements) {
            crossing.left -= *px;
            crossing.right -= *px;
        }
    }
}
