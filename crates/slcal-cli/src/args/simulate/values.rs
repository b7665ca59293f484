//! Parsers of poses, lenses and bends.

use slcal_core::Error;
use slcal_core::simulate::BendConfig;

/// Tilts and roll, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PoseArg(pub(crate) [f64; 3]);

/// k1, k2, p1, p2, k3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Distortion(pub(crate) [f64; 5]);

/// Columns and rows of the panel, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ProjectorOffset(pub(crate) [f64; 2]);

pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|t| t.trim().parse::<f64>().ok().filter(|x| x.is_finite())).collect()
}

pub(super) fn parse_pose(text: &str) -> Result<PoseArg, String> {
    match numbers(text).as_deref() {
        Some(&[x, y]) => Ok(PoseArg([x, y, 0.0])),
        Some(&[x, y, roll]) => Ok(PoseArg([x, y, roll])),
        _ => Err("expected two or three finite angles in degrees, such as 25,28 or 25,-28,5".to_owned()),
    }
}

pub(super) fn parse_distortion(text: &str) -> Result<Distortion, String> {
    let wrong = || "expected one to five finite coefficients k1,k2,p1,p2,k3, such as -0.12,0.02".to_owned();
    let given = numbers(text).filter(|k| k.len() <= 5).ok_or_else(wrong)?;
    let mut all = [0.0; 5];
    all.iter_mut().zip(given).for_each(|(k, g)| *k = g);
    Ok(Distortion(all))
}

pub(super) fn parse_projector_offset(text: &str) -> Result<ProjectorOffset, String> {
    match numbers(text).as_deref() {
        Some(&[right]) => Ok(ProjectorOffset([right, 0.0])),
        Some(&[right, down]) => Ok(ProjectorOffset([right, down])),
        _ => Err("expected one or two finite numbers, such as 80 or 80,-12".to_owned()),
    }
}

pub(super) fn parse_bend(text: &str) -> Result<BendConfig, String> {
    text.parse().map_err(|error| match error {
        Error::Invalid { expected, .. } => format!("expected {expected}"),
        other => other.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_and_coefficients() {
        assert_eq!(parse_pose("25,-28"), Ok(PoseArg([25.0, -28.0, 0.0])));
        assert!(parse_pose("25").is_err() && parse_pose("1,2,3,4").is_err() && parse_pose("1,nan").is_err());
        assert_eq!(parse_distortion("-0.1,0.02"), Ok(Distortion([-0.1, 0.02, 0.0, 0.0, 0.0])));
        assert!(parse_distortion("1,2,3,4,5,6").is_err());
        assert_eq!(parse_projector_offset("80"), Ok(ProjectorOffset([80.0, 0.0])));
        assert_eq!(parse_projector_offset("-80, 12"), Ok(ProjectorOffset([-80.0, 12.0])));
        for text in ["", "nan", "1,2,3", "a"] {
            assert!(parse_projector_offset(text).is_err(), "{text}");
        }
        assert_eq!(parse_bend("0.5%,20,wave").unwrap().to_string(), "0.5%,20,wave");
        assert!(parse_bend("3").unwrap_err().starts_with("expected SAG"));
    }
}
