//! Sequences that are not what they are said to be.

use super::tests::{HEIGHT, PANEL, Scene, USUAL, WIDTH, decode, phase, views};
use super::*;
use crate::pattern::{SequencePattern, SequencePreset};
use crate::photo::{Layout, PhotoView, Samples};

fn opencv() -> SequencePattern {
    SequencePattern::preset(PANEL, SequencePreset::OpencvGray, Some(8)).unwrap()
}

fn failure(pattern: &SequencePattern, frames: &[Vec<u8>]) -> String {
    decode(pattern, frames).unwrap_err().to_string()
}

/// The frames in another order.
fn ordered(frames: &[Vec<u8>], order: impl IntoIterator<Item = usize>) -> Vec<Vec<u8>> {
    order.into_iter().map(|i| frames[i].clone()).collect()
}

#[test]
fn frames_that_are_missing_twice_or_of_another_size_are_named() {
    let pattern = opencv();
    let frames = USUAL.frames(&pattern, 1);
    let n = frames.len();
    let views = views(&frames);
    let mut decoder = SequenceDecoder::new(&pattern, SequenceDecodeConfig::default()).unwrap();
    assert!(
        decoder
            .decode(&views[..n - 1])
            .unwrap_err()
            .to_string()
            .contains(&format!("{n}, as the pattern has"))
    );
    for i in (0..n).filter(|i| *i != 7) {
        decoder.push(i, views[i]).unwrap();
    }
    let message = decoder.finish().unwrap_err().to_string();
    assert!(message.contains("no frame 7 (bit 4 of the columns, inverted)"), "{message}");
    assert!(decoder.push(3, views[3]).unwrap_err().to_string().contains("frame 3"));
    assert!(decoder.push(n, views[0]).unwrap_err().to_string().contains(&format!("below {n}")));
    decoder.clear();
    decoder.push(0, views[0]).unwrap();
    let small = [0_u8; 300];
    let other = PhotoView::new(Samples::U8(&small), 20, 15, 20, Layout::Grey).unwrap();
    let message = decoder.push(1, other).unwrap_err().to_string();
    assert!(message.contains("400x300 px") && message.contains("20x15 px"), "{message}");
    let deep = vec![0_u16; WIDTH * HEIGHT];
    let other = PhotoView::new(Samples::U16(&deep), WIDTH, HEIGHT, WIDTH, Layout::Grey).unwrap();
    assert!(decoder.push(1, other).unwrap_err().to_string().contains("16 bit"));
    // A frame that was refused may come again as it should be.
    decoder.push(1, views[1]).unwrap();
    // Of frames in memory that were refused together none has come.
    let mut mixed = views.clone();
    mixed[2] = other;
    assert!(decoder.decode(&mixed).unwrap_err().to_string().contains("16 bit"));
    decoder.push(0, views[0]).unwrap();

    let mut twice = frames.clone();
    twice[5] = frames[4].clone();
    let message = failure(&pattern, &twice);
    assert!(message.contains("frames 4 ") && message.contains("same pixels"), "{message}");
}

#[test]
fn another_order_is_named() {
    let pattern = opencv();
    let frames = USUAL.frames(&pattern, 1);
    let n = frames.len();
    assert!(decode(&pattern, &frames).is_ok());
    let pair = |i: usize| [2 * i, 2 * i + 1];
    let levels = [n - 2, n - 1];
    let least_first: Vec<usize> =
        (0..8).rev().flat_map(pair).chain((8..16).rev().flat_map(pair)).chain(levels).collect();
    let inverses_first: Vec<usize> = (0..16).flat_map(|i| [2 * i + 1, 2 * i]).chain(levels).collect();
    for (order, word) in [
        (least_first, "least significant bit comes first"),
        (inverses_first, "after its inverse"),
        ((0..n - 2).chain([n - 1, n - 2]).collect(), "white is darker than black"),
        (vec![n - 1].into_iter().chain(0..n - 1).collect(), ""),
        ((0..n).rev().collect(), ""),
        ((0..n).map(|i| (7 * i) % n).collect(), ""),
    ] {
        let message = failure(&pattern, &ordered(&frames, order.iter().copied()));
        assert!(message.contains("order of the pattern") && message.contains(word), "{word}: {message}");
    }
}

#[test]
fn a_longer_exposure_is_named() {
    let pattern = opencv();
    for factor in [1.1, 1.25] {
        let mut frames = Scene { albedo: 0.6, ..USUAL }.frames(&pattern, 1);
        frames[6].iter_mut().for_each(|v| *v = (f64::from(*v) * factor).min(255.0) as u8);
        let message = failure(&pattern, &frames);
        assert!(
            message.contains("frame 6 (bit 4 of the columns)") && message.contains("exposure"),
            "{message}"
        );
    }
}

#[test]
fn a_scene_that_moved_is_told_with_where() {
    let pattern = opencv();
    let mut frames = USUAL.frames(&pattern, 1);
    let n = frames.len();
    // From the tenth frame on something dark stands before a part of it.
    for frame in &mut frames[10..n - 2] {
        for v in 80..160 {
            frame[v * WIDTH + 200..v * WIDTH + 300].fill(9);
        }
    }
    let report = decode(&pattern, &frames).unwrap().report;
    assert_eq!(report.warnings.len(), 1, "{report:?}");
    let message = &report.warnings[0].message;
    let numbers: Vec<i32> =
        message.split(|c: char| !c.is_ascii_digit()).filter_map(|word| word.parse().ok()).collect();
    let close = |found: i32, expected: i32| (found - expected).abs() < 25;
    assert!(
        [200, 80, 299, 159].iter().zip(&numbers[2..]).all(|(e, f)| close(*f, *e)),
        "{message}: {numbers:?}"
    );
}

#[test]
fn overexposed_sinusoids_are_told() {
    let pattern = phase(None, 16.0, 8);
    let report = decode(&pattern, &Scene { albedo: 1.5, ..USUAL }.frames(&pattern, 1)).unwrap().report;
    assert_eq!(report.warnings[0].code, "saturated", "{report:?}");
    let usual = decode(&pattern, &USUAL.frames(&pattern, 1)).unwrap().report;
    assert!(usual.warnings.is_empty(), "{usual:?}");
}

#[test]
fn a_dark_projector_and_the_pictures_themselves_are_refused() {
    let pattern = opencv();
    let mut dark = Scene { albedo: 0.0, ..USUAL };
    dark.noise = 2.0;
    let message = failure(&pattern, &dark.frames(&pattern, 1));
    assert!(message.contains("light of the projector not found"), "{message}");
    let pictures: Vec<_> = (0..pattern.frames.len()).map(|i| pattern.image(i).unwrap()).collect();
    let views: Vec<PhotoView<'_>> = pictures
        .iter()
        .map(|p| PhotoView::new(Samples::U8(p.as_raw()), 1024, 768, 1024, Layout::Grey).unwrap())
        .collect();
    let mut decoder = SequenceDecoder::new(&pattern, SequenceDecodeConfig::default()).unwrap();
    let message = decoder.decode(&views).unwrap_err().to_string();
    assert!(message.contains("parallax"), "{message}");
}
