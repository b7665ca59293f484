//! Votes of the aligned scanlines along each track.

use crate::decode::crossing_features::NONE;
use crate::decode::tracks::Tracks;

/// Share of the votes cast that the winner needs, and share of all scanlines in reach that must have voted for it.
const MIN_SHARE: f32 = 0.6;
const MIN_SUPPORT: f32 = 0.4;

/// The slit of a crossing and the support for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::decode) struct VotedLabel {
    /// Position in the order of slits; [`NONE`] when undecided.
    pub(in crate::decode) label: u16,
    /// Share of the aligned scanlines in reach that agree, 0–1.
    pub(in crate::decode) support: f32,
}

pub(super) const UNDECIDED: VotedLabel = VotedLabel { label: NONE, support: 0.0 };

/// Working memory of [`VoteCounter::count`].
#[derive(Debug, Clone, Default)]
pub(super) struct VoteCounter {
    /// Votes of one track: the position on the track and the label.
    cast: Vec<(usize, u16)>,
    /// Votes within reach, by label.
    counts: Vec<(u16, u32)>,
}

impl VoteCounter {
    /// Writes the winner among the votes within ± `reach` scanlines along the track, for each crossing, into `votes`.
    /// `label_of` returns the label of a crossing on a scanline that votes, which may be [`NONE`], and `None` for others.
    pub(super) fn count(
        &mut self,
        tracks: &Tracks,
        reach: usize,
        label_of: impl Fn(usize) -> Option<u16>,
        votes: &mut [VotedLabel],
    ) {
        let Self { cast, counts } = self;
        for track in tracks.iter() {
            cast.clear();
            cast.extend(track.iter().enumerate().filter_map(|(at, &i)| Some((at, label_of(i as usize)?))));
            counts.clear();
            // The votes in the window about a crossing, those for no slit included.
            let (mut from, mut to) = (0, 0);
            let mut vote = UNDECIDED;
            for (at, &i) in track.iter().enumerate() {
                let (first, last) = (from, to);
                while to < cast.len() && cast[to].0 <= at + reach {
                    change(counts, cast[to].1, 1);
                    to += 1;
                }
                while from < to && cast[from].0 + reach < at {
                    change(counts, cast[from].1, -1);
                    from += 1;
                }
                // The window seldom changes.
                if to > last || from > first {
                    vote = winner(counts, (to - from) as u32);
                }
                votes[i as usize] = vote;
            }
        }
    }
}

fn change(counts: &mut Vec<(u16, u32)>, label: u16, by: i32) {
    if label == NONE {
        return;
    }
    match counts.iter_mut().find(|c| c.0 == label) {
        Some(c) => c.1 = c.1.saturating_add_signed(by),
        None if by > 0 => counts.push((label, 1)),
        None => {}
    }
}

fn winner(counts: &[(u16, u32)], voters: u32) -> VotedLabel {
    let cast: u32 = counts.iter().map(|c| c.1).sum();
    let Some(first) = counts.iter().max_by_key(|c| c.1).filter(|c| c.1 > 0) else { return UNDECIDED };
    let (share, support) = (first.1 as f32 / cast as f32, first.1 as f32 / voters.max(1) as f32);
    let decided = share >= MIN_SHARE && support >= MIN_SUPPORT;
    VotedLabel { label: if decided { first.0 } else { NONE }, support }
}
