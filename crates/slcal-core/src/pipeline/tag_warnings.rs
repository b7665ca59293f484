//! What the tags of all photographs tell about a rig that was calibrated from them.

use super::photo_tags::{Finding, contradiction, examine};
use super::taken::Taken;
use crate::calibrate::{CalibrateConfig, PrincipalPointRule};
use crate::rig::{Rig, Warning};

/// Focal lengths in tags that differ by more are of a lens that was zoomed: cameras with a fixed lens always write the same.
const ZOOMED: f64 = 0.05;

/// Looks at all photographs; of several with the same finding the first is named.
pub(super) fn of_tags(rig: &Rig, config: &CalibrateConfig, taken: &[Taken]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let tagged = || taken.iter().filter_map(|t| Some((t, t.tags.as_ref()?)));
    // Where the principal point is given, or expected nowhere, it does not matter where the middle of the picture is.
    let by_the_middle = config.known_camera.is_none()
        && !matches!(config.camera_pp, PrincipalPointRule::Exact(..) | PrincipalPointRule::Free);
    if by_the_middle {
        let cropped = tagged().filter_map(|(t, tags)| examine(rig, &t.title, tags, t.size));
        findings.extend(one_for_all(cropped.collect()));
    }
    // A focal length that was expected is compared with the result already; that of a cropped picture means nothing.
    if config.focal_prior.is_none() && !findings.iter().any(|f: &Finding| f.doubtful) {
        let differs = tagged().filter_map(|(t, tags)| contradiction(rig, &t.title, tags, t.size));
        let differs = differs.map(|(warning, doubtful)| Finding { warning, doubtful });
        findings.extend(one_for_all(differs.collect()));
    }
    findings.extend(zoomed(taken).map(|warning| Finding { warning, doubtful: false }));
    findings
}

/// The first finding, with the number of photographs that share it.
fn one_for_all(findings: Vec<Finding>) -> Option<Finding> {
    let others = findings.len().saturating_sub(1);
    let mut first = findings.into_iter().next()?;
    if others > 0 {
        let word = if others == 1 { "photograph" } else { "photographs" };
        first.warning.message = format!("{} (and so for {others} other {word})", first.warning.message);
    }
    Some(first)
}

/// Photographs between which the lens was zoomed.
fn zoomed(taken: &[Taken]) -> Option<Warning> {
    let stated = |t: &Taken| t.tags.as_ref()?.focal_mm.filter(|mm| mm.is_finite() && *mm > 0.0);
    let mut all = taken.iter().filter_map(|t| Some((t, stated(t)?)));
    let (first, mm) = all.next()?;
    let (other, different) = all.find(|(_, other)| (other / mm).ln().abs() > ZOOMED)?;
    Some(Warning::new(
        "exif-focal-differs",
        format!(
            "the lens was zoomed between the photographs: the EXIF tags of {} state {mm:.1} mm, those of {} {different:.1} mm",
            first.title, other.title
        ),
        "take all photographs at one setting of the zoom, and leave it there while the rig is used",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Camera;
    use crate::pipeline::photo_tags::{PhotoTags, Turn};
    use crate::rig::{Device, DeviceSigma};

    /// A camera of 1000 px in 1000 x 750 that is known to this many px.
    fn rig(focal: f64, centre: f64) -> Rig {
        let model = Camera::pinhole([1000, 750], 1000.0).unwrap();
        let sigma = DeviceSigma { focal_px: focal, cx_px: centre, cy_px: centre, ..DeviceSigma::default() };
        let camera = Device { model, sigma: Some(sigma) };
        Rig {
            camera,
            projector: None,
            views: Vec::new(),
            method: "ml".into(),
            quality: None,
            covariance: None,
            channel_registration: None,
        }
    }

    fn found(rig: &Rig, tags: &[PhotoTags]) -> Vec<(String, bool)> {
        let taken = |(i, tags): (usize, &PhotoTags)| Taken {
            title: format!("{i}.jpg"),
            size: [1000, 750],
            tags: Some(tags.clone()),
            turn: Turn(0),
        };
        let taken: Vec<Taken> = tags.iter().enumerate().map(taken).collect();
        let findings = of_tags(rig, &CalibrateConfig::default(), &taken);
        findings.into_iter().map(|f| (f.warning.code, f.doubtful)).collect()
    }

    /// Tags with this 35 mm equivalent of the right focal length, times a factor.
    fn tags(factor: f64, pixels: [u32; 2]) -> PhotoTags {
        let right = 1000.0 / 1250.0 * crate::geometry::FILM_DIAGONAL_MM;
        PhotoTags { focal_35mm: Some(factor * right), pixels: Some(pixels), ..PhotoTags::default() }
    }

    const WHOLE: [u32; 2] = [1000, 750];

    #[test]
    fn both_sigmas_count_in_a_contradiction() {
        // 14 % are less than 3 σ of 5 %, 17 % are more, 40 % more than 6; a focal length that is itself known to 10 % allows 17 %.
        for (factor, focal, expected) in [
            (1.14, 2.0, None),
            (1.17, 2.0, Some(false)),
            (0.85, 2.0, Some(false)),
            (1.4, 2.0, Some(true)),
            (1.17, 100.0, None),
        ] {
            let found = found(&rig(focal, 1.0), &[tags(factor, WHOLE)]);
            let expected: Vec<_> =
                expected.map(|doubtful| ("exif-focal-differs".to_owned(), doubtful)).into_iter().collect();
            assert_eq!(found, expected, "{factor} {focal}");
        }
        // What was a prior is compared already.
        let config = CalibrateConfig {
            focal_prior: Some(crate::calibrate::FocalPrior { focal_px: 500.0, sigma_share: 0.05 }),
            ..CalibrateConfig::default()
        };
        let taken = Taken { title: "a".into(), size: WHOLE, tags: Some(tags(0.5, WHOLE)), turn: Turn(0) };
        assert!(of_tags(&rig(2.0, 1.0), &config, &[taken]).is_empty());
    }

    #[test]
    fn crops_are_told_from_pictures_that_were_resized() {
        let code = |doubtful| vec![("cropped".to_owned(), doubtful)];
        let without = |pixels| PhotoTags { focal_35mm: None, ..tags(1.0, pixels) };
        let (uncertain, determined) = (rig(20.0, 15.0), rig(2.0, 1.0));
        assert!(found(&uncertain, &[without(WHOLE)]).is_empty());
        // Another shape.
        assert_eq!(found(&uncertain, &[without([1200, 800])]), code(true));
        assert_eq!(found(&determined, &[without([1200, 800])]), code(false));
        // The same shape: half of a picture is a small one, nine tenths are a crop, unless the focal length says otherwise.
        assert!(found(&uncertain, &[without([2000, 1500])]).is_empty());
        assert_eq!(found(&uncertain, &[without([1100, 825])]), code(false));
        assert!(found(&uncertain, &[tags(1.0, [2000, 1500])]).is_empty());
        assert_eq!(found(&uncertain, &[tags(0.5, [2000, 1500])]), code(true));
        assert!(found(&uncertain, &[tags(1.0, [1300, 975])]).is_empty());
        // Tags of another picture, or of none.
        assert!(found(&uncertain, &[without([160, 110]), without([0, 0]), without([500, 375])]).is_empty());
    }

    #[test]
    fn a_principal_point_that_is_given_does_not_need_the_middle() {
        let taken =
            Taken { title: "a".into(), size: WHOLE, tags: Some(tags(1.0, [1200, 800])), turn: Turn(0) };
        for (rule, warnings) in [
            (PrincipalPointRule::Prior, 1),
            (PrincipalPointRule::Centre, 1),
            (PrincipalPointRule::Exact(400.0, 300.0), 0),
            (PrincipalPointRule::Free, 0),
        ] {
            let config = CalibrateConfig { camera_pp: rule, ..CalibrateConfig::default() };
            assert_eq!(
                of_tags(&rig(2.0, 0.0), &config, std::slice::from_ref(&taken)).len(),
                warnings,
                "{rule:?}"
            );
        }
    }

    #[test]
    fn several_photographs_with_one_finding_are_told_once_and_a_zoom_by_name() {
        let taken = |title: &str, mm| {
            let tags = PhotoTags { focal_mm: Some(mm), ..tags(1.0, [1200, 800]) };
            Taken { title: title.into(), size: WHOLE, tags: Some(tags), turn: Turn(0) }
        };
        let findings = of_tags(
            &rig(20.0, 15.0),
            &CalibrateConfig::default(),
            &[taken("a", 18.0), taken("b", 18.0), taken("c", 35.0)],
        );
        let messages: Vec<&str> = findings.iter().map(|f| f.warning.message.as_str()).collect();
        assert_eq!(messages.len(), 2, "{messages:?}");
        assert!(
            messages[0].starts_with("a: ") && messages[0].ends_with("(and so for 2 other photographs)"),
            "{messages:?}"
        );
        assert!(messages[1].contains("a state 18.0 mm, those of c 35.0 mm"), "{messages:?}");
    }
}
