//! Parsers of poses and lenses.

pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|t| t.trim().parse::<f64>().ok().filter(|x| x.is_finite())).collect()
}

/// Tilts and roll, degrees.
pub(super) fn parse_pose(text: &str) -> Result<[f64; 3], String> {
    match numbers(text).as_deref() {
        Some(&[x, y]) => Ok([x, y, 0.0]),
        Some(&[x, y, roll]) => Ok([x, y, roll]),
        _ => Err("expected two or three finite angles in degrees, such as 25,28 or 25,-28,5".to_owned()),
    }
}

/// k1, k2, p1, p2, k3.
pub(super) fn parse_distortion(text: &str) -> Result<[f64; 5], String> {
    let wrong = || "expected one to five finite coefficients k1,k2,p1,p2,k3, such as -0.12,0.02".to_owned();
    let given = numbers(text).filter(|k| k.len() <= 5).ok_or_else(wrong)?;
    let mut all = [0.0; 5];
    all.iter_mut().zip(given).for_each(|(k, g)| *k = g);
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_and_coefficients() {
        assert_eq!(parse_pose("25,-28"), Ok([25.0, -28.0, 0.0]));
        assert!(parse_pose("25").is_err() && parse_pose("1,2,3,4").is_err() && parse_pose("1,nan").is_err());
        assert_eq!(parse_distortion("-0.1,0.02"), Ok([-0.1, 0.02, 0.0, 0.0, 0.0]));
        assert!(parse_distortion("1,2,3,4,5,6").is_err());
    }
}
