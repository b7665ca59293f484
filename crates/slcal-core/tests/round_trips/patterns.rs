//! Sequences of colours, and the drawn patterns.

use std::collections::HashSet;

use proptest::prelude::*;
use slcal_core::format::{read_pattern, write_pattern};
use slcal_core::pattern::{Axis, Pattern, StripeConfig, StripePattern};

fn stripes() -> impl Strategy<Value = StripePattern> {
    let axis = prop_oneof![Just(Axis::Columns), Just(Axis::Rows)];
    let parameters = (2_u32..=6, 2_u32..=4, 0.0..1.0, axis, 0.2..0.8, [800_u32..2000, 800_u32..2000]);
    parameters.prop_filter_map("too many slits", |(hues, order, share, axis, lit, panel)| {
        let windows = hues.pow(order);
        let slits = 3 + (share * f64::from(windows.min(390))) as u32;
        let config = StripeConfig { hues, order, slits: Some(slits), axis, lit };
        StripePattern::new(panel, &config).ok()
    })
}

proptest! {
    #[test]
    fn every_window_of_colours_occurs_once(pattern in stripes()) {
        let windows = pattern.sequence.windows(pattern.order as usize);
        let mut seen = HashSet::new();
        for window in windows {
            prop_assert!(seen.insert(window), "{window:?} twice");
        }
        prop_assert!(pattern.sequence.iter().all(|hue| usize::from(*hue) < pattern.palette.len()));
    }

    #[test]
    fn slits_ascend_over_the_panel_with_gaps_between_them(pattern in stripes()) {
        let half = pattern.width_px / 2.0;
        let edges: Vec<f64> = pattern.centres_px.iter().flat_map(|c| [c - half, c + half]).collect();
        prop_assert!(edges.is_sorted() && edges[0] >= -0.5 && edges[edges.len() - 1] <= pattern.length_px() - 0.5);
        prop_assert!(pattern.centres_px.windows(2).all(|pair| pair[1] - pair[0] > pattern.width_px));
    }

    #[test]
    fn a_pattern_survives_its_file(pattern in stripes()) {
        let pattern = Pattern::Stripes(pattern);
        let mut text = Vec::new();
        write_pattern(&pattern, &mut text).unwrap();
        prop_assert_eq!(read_pattern(text.as_slice()).unwrap(), pattern);
    }
}
