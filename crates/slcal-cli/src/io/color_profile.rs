//! ICC profiles, as far as they matter here: their name, and the curve from samples to light.
//!
//! Primaries move colours, not edges, so that nothing else is read.

use super::transfer_curve::Curve;

/// The header of a profile, before the table of its tags.
const HEADER: usize = 128;
/// A profile has some twenty tags; more are not looked at.
const MOST_TAGS: usize = 200;
/// Longest name that is told, characters.
const LONGEST_NAME: usize = 80;

/// What a profile says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColorProfile {
    /// As its author called it.
    pub(super) name: Option<String>,
    /// Its curves, of one channel or three; `None` where it has tables or no light at all (CMYK).
    pub(super) curves: Option<Vec<Curve>>,
}

impl ColorProfile {
    /// The profile in these bytes; `None` for what is no profile.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        if bytes.get(36..40) != Some(b"acsp") {
            return None;
        }
        let tag = |name: &[u8; 4]| tag(bytes, *name);
        let curves = |names: &[&[u8; 4]]| names.iter().map(|name| curve(tag(name)?)).collect();
        let curves = match bytes.get(16..20)? {
            b"RGB " => curves(&[b"rTRC", b"gTRC", b"bTRC"]),
            b"GRAY" => curves(&[b"kTRC"]),
            _ => None,
        };
        Some(Self { name: tag(b"desc").and_then(description), curves })
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|b| u16::from_be_bytes(*b))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..)?.first_chunk().map(|b| u32::from_be_bytes(*b) as usize)
}

/// A number of 16 bits before the point and 16 behind it.
fn fixed_at(bytes: &[u8], at: usize) -> Option<f64> {
    bytes.get(at..)?.first_chunk().map(|b| f64::from(i32::from_be_bytes(*b)) / 65536.0)
}

/// The content of a tag.
fn tag(bytes: &[u8], name: [u8; 4]) -> Option<&[u8]> {
    let (_, table) = bytes.get(HEADER..)?.split_at_checked(4)?;
    let (entries, _) = table.as_chunks::<12>();
    let count = u32_at(bytes, HEADER)?.min(MOST_TAGS);
    let entry = entries.iter().take(count).find(|entry| entry.starts_with(&name))?;
    let (at, length) = (u32_at(entry, 4)?, u32_at(entry, 8)?);
    bytes.get(at..at.checked_add(length)?)
}

/// The text of a `desc` tag: ASCII in version 2, in several languages of UTF-16 in version 4.
fn description(tag: &[u8]) -> Option<String> {
    let text = match tag.get(..4)? {
        b"desc" => {
            let length = u32_at(tag, 8)?;
            String::from_utf8_lossy(tag.get(12..12_usize.checked_add(length)?)?).into_owned()
        }
        b"mluc" => {
            // The first language; records are 12 bytes long and begin behind the header.
            let (length, at) = (u32_at(tag, 20)?, u32_at(tag, 24)?);
            let (units, _) = tag.get(at..at.checked_add(length)?)?.as_chunks::<2>();
            let units: Vec<u16> = units.iter().map(|b| u16::from_be_bytes(*b)).collect();
            String::from_utf16_lossy(&units)
        }
        _ => return None,
    };
    let plain: String = text.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
    Some(plain.trim().to_owned()).filter(|name| !name.is_empty())
}

/// The curve in a tag `rTRC`, `gTRC`, `bTRC` or `kTRC`.
fn curve(tag: &[u8]) -> Option<Curve> {
    match tag.get(..4)? {
        b"curv" => {
            let count = u32_at(tag, 8)?;
            match count {
                0 => Some(Curve::Linear),
                // 8 bits before the point and 8 behind it.
                1 => Curve::power(f64::from(u16_at(tag, 12)?) / 256.0),
                _ => {
                    let (values, _) = tag.get(12..12_usize.checked_add(count.checked_mul(2)?)?)?.as_chunks();
                    Some(Curve::Table(values.iter().map(|b| u16::from_be_bytes(*b)).collect()))
                }
            }
        }
        b"para" => {
            let kind = u16_at(tag, 8)?;
            let p = |i: usize| fixed_at(tag, 12 + 4 * i);
            // ICC.1:2022, table 68: Y = (aX + b)^g + e from X = d on, cX + f below.
            let [g, a, b, c, d, e, f] = match kind {
                0 => [p(0)?, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                1 => [p(0)?, p(1)?, p(2)?, 0.0, -p(2)? / p(1)?, 0.0, 0.0],
                2 => [p(0)?, p(1)?, p(2)?, 0.0, -p(2)? / p(1)?, p(3)?, p(3)?],
                3 => [p(0)?, p(1)?, p(2)?, p(3)?, p(4)?, 0.0, 0.0],
                4 => [p(0)?, p(1)?, p(2)?, p(3)?, p(4)?, p(5)?, p(6)?],
                _ => return None,
            };
            Some(Curve::Parametric { g, a, b, c, d, e, f }).filter(Curve::is_sound)
        }
        _ => None,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A profile with these tags.
    pub(crate) fn profile(space: [u8; 4], tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
        let mut bytes = vec![0; HEADER];
        bytes[12..16].copy_from_slice(b"mntr");
        bytes[16..20].copy_from_slice(&space);
        bytes[20..24].copy_from_slice(b"XYZ ");
        bytes[36..40].copy_from_slice(b"acsp");
        bytes.extend((tags.len() as u32).to_be_bytes());
        let mut at = HEADER + 4 + 12 * tags.len();
        for (name, content) in tags {
            bytes.extend_from_slice(*name);
            bytes.extend((at as u32).to_be_bytes());
            bytes.extend((content.len() as u32).to_be_bytes());
            at += content.len();
        }
        for (_, content) in tags {
            bytes.extend(content);
        }
        let length = bytes.len() as u32;
        bytes[..4].copy_from_slice(&length.to_be_bytes());
        bytes
    }

    /// A description as of version 2.
    pub(crate) fn named(name: &str) -> Vec<u8> {
        let mut tag = b"desc\0\0\0\0".to_vec();
        tag.extend((name.len() as u32 + 1).to_be_bytes());
        tag.extend(name.as_bytes());
        tag.push(0);
        tag
    }

    /// A curve that is an exponent.
    pub(crate) fn exponent(gamma: f64) -> Vec<u8> {
        let mut tag = b"curv\0\0\0\0\0\0\0\x01".to_vec();
        tag.extend(((gamma * 256.0).round() as u16).to_be_bytes());
        tag
    }

    /// Three channels with the same curve.
    pub(crate) fn rgb(name: &str, curve: &[u8]) -> Vec<u8> {
        let curves = [b"rTRC", b"gTRC", b"bTRC"].map(|channel| (channel, curve.to_vec()));
        let tags: Vec<_> = [(b"desc", named(name))].into_iter().chain(curves).collect();
        profile(*b"RGB ", &tags)
    }

    /// The curve of sRGB as profiles of version 4 have it.
    pub(crate) fn srgb_curve() -> Vec<u8> {
        let mut tag = b"para\0\0\0\0\0\x03\0\0".to_vec();
        for number in [2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045] {
            tag.extend(((number * 65536.0_f64).round() as i32).to_be_bytes());
        }
        tag
    }

    #[test]
    fn names_and_curves_are_read() {
        let adobe = ColorProfile::read(&rgb("Adobe RGB (1998)", &exponent(2.199_22))).unwrap();
        assert_eq!(adobe.name.as_deref(), Some("Adobe RGB (1998)"));
        let curves = adobe.curves.unwrap();
        assert!(
            curves.len() == 3 && curves.iter().all(|c| (c.light(0.5) - 0.5_f64.powf(2.199)).abs() < 1e-3)
        );
        // Display P3 as telephones write it: its name in UTF-16, the curve of sRGB.
        let name: Vec<u8> = "Display P3".encode_utf16().flat_map(u16::to_be_bytes).collect();
        let mut desc = b"mluc\0\0\0\0\0\0\0\x01\0\0\0\x0cenUS\0\0\0\x14\0\0\0\x1c".to_vec();
        desc.extend(name);
        let mut tags = vec![(b"desc", desc)];
        tags.extend([b"rTRC", b"gTRC", b"bTRC"].map(|channel| (channel, srgb_curve())));
        let p3 = ColorProfile::read(&profile(*b"RGB ", &tags)).unwrap();
        assert_eq!(p3.name.as_deref(), Some("Display P3"));
        assert!(p3.curves.unwrap().iter().all(Curve::is_srgb));
    }

    #[test]
    fn tables_grey_and_inks() {
        let table: Vec<u8> = [0_u16, 16384, 65535].into_iter().flat_map(u16::to_be_bytes).collect();
        let curv = [b"curv\0\0\0\0\0\0\0\x03".as_slice(), &table].concat();
        let grey = ColorProfile::read(&profile(*b"GRAY", &[(b"kTRC", curv)])).unwrap();
        let curves = grey.curves.unwrap();
        assert!(grey.name.is_none() && (curves[0].light(0.25) - 0.125).abs() < 1e-4);
        let linear = ColorProfile::read(&rgb("linear", b"curv\0\0\0\0\0\0\0\0")).unwrap();
        assert_eq!(linear.curves.unwrap()[1], Curve::Linear);
        let inks = ColorProfile::read(&profile(*b"CMYK", &[(b"desc", named("SWOP"))])).unwrap();
        assert!(inks.curves.is_none() && inks.name.is_some());
    }

    #[test]
    fn profiles_that_are_cut_or_lie_are_no_harm() {
        let whole = rgb("Adobe RGB (1998)", &exponent(2.2));
        for length in 0..whole.len() {
            let _ = ColorProfile::read(&whole[..length]);
        }
        for at in 0..whole.len() {
            for value in [0, 0x7F, 0xFF] {
                let mut lying = whole.clone();
                lying[at] = value;
                let _ = ColorProfile::read(&lying);
            }
        }
        // Exponents and parameters from which no light comes.
        for curve in [exponent(0.0), [b"para\0\0\0\0\0\x01\0\0".as_slice(), &[0; 12]].concat()] {
            assert!(ColorProfile::read(&rgb("x", &curve)).unwrap().curves.is_none());
        }
        assert!(ColorProfile::read(b"").is_none() && ColorProfile::read(&[0; 400]).is_none());
    }
}
