//! What a photograph's file says about how its samples are coded.

use super::color_profile::ColorProfile;
use super::transfer_curve::Curve;

/// How samples are coded.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Coding {
    /// As sRGB or nearly so, or nothing is said. The text is worth telling where there is one.
    Srgb(Option<String>),
    /// By these curves. The text says where this stands, and the curve.
    Curves {
        says: String,
        /// One for all channels, or one for each.
        curves: Vec<Curve>,
        /// Black at 16 of 255 and white at 235.
        narrow: bool,
    },
    /// In a way that is not read, by its name.
    Refused(&'static str),
}

/// The coding by a profile and, of PNG, by the chunks before the picture: the first that says something of cICP, iCCP, sRGB
/// and gAMA (PNG, third edition, 4.3).
pub(super) fn coding(png: Option<&[u8]>, profile: Option<&[u8]>) -> Coding {
    let chunks = png.map(Chunks::before_picture).unwrap_or_default();
    if let Some(coding) = chunks.cicp.and_then(of_cicp) {
        return coding;
    }
    if let Some(profile) = profile {
        return of_profile(ColorProfile::read(profile));
    }
    match chunks.gama.filter(|_| !chunks.srgb) {
        Some(gamma) => of_gamma(gamma),
        // The decoder hands over no profile that is damaged, or too large for any use.
        None if chunks.has_profile => {
            Coding::Srgb(Some("its colour profile cannot be read; its samples are taken for sRGB".into()))
        }
        None => Coding::Srgb(None),
    }
}

/// The chunks of a PNG that say how its samples are coded.
#[derive(Debug, Default)]
struct Chunks {
    /// Primaries, transfer function, matrix, whether the range is full.
    cicp: Option<[u8; 4]>,
    srgb: bool,
    /// An iCCP chunk.
    has_profile: bool,
    /// 100,000 times the exponent from light to sample.
    gama: Option<u32>,
}

impl Chunks {
    fn before_picture(png: &[u8]) -> Self {
        let mut found = Self::default();
        let mut rest = png.get(8..).unwrap_or_default();
        while let Some((head, behind)) = rest.split_first_chunk::<8>() {
            let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
            let Some((content, behind)) = behind.split_at_checked(length) else { break };
            match &head[4..] {
                b"IDAT" | b"IEND" => break,
                b"cICP" if found.cicp.is_none() => found.cicp = content.try_into().ok(),
                b"sRGB" => found.srgb = true,
                b"iCCP" => found.has_profile = true,
                b"gAMA" if found.gama.is_none() => {
                    found.gama = content.try_into().ok().map(u32::from_be_bytes);
                }
                _ => {}
            }
            // Behind the checksum.
            rest = behind.get(4..).unwrap_or_default();
        }
        found
    }
}

/// By code points of ITU-T H.273; `None` where they say nothing.
fn of_cicp([_, transfer, _, full_range]: [u8; 4]) -> Option<Coding> {
    let curve = match transfer {
        1 | 6 | 11 | 14 | 15 => Curve::Bt709,
        4 => Curve::Power(2.2),
        5 => Curve::Power(2.8),
        8 => Curve::Linear,
        13 => Curve::Srgb,
        16 => return Some(Coding::Refused("PQ (HDR)")),
        18 => return Some(Coding::Refused("HLG (HDR)")),
        // Unspecified or reserved.
        0 | 2 | 3 => return None,
        other => {
            let says = format!(
                "its cICP chunk names transfer function {other}, which is not known; its samples are taken for sRGB"
            );
            return Some(Coding::Srgb(Some(says)));
        }
    };
    let narrow = full_range == 0;
    if curve.is_srgb() && !narrow {
        return Some(Coding::Srgb(None));
    }
    let range = if narrow { " in the narrow range of video" } else { "" };
    let says = format!("its cICP chunk says that its samples are {}{range}", curve.named());
    Some(Coding::Curves { says, curves: vec![curve], narrow })
}

fn of_gamma(gamma: u32) -> Coding {
    let stated = f64::from(gamma) / 100_000.0;
    let Some(curve) = Curve::power(stated.recip()) else {
        let says =
            format!("its gAMA chunk says {stated}, which no picture has; its samples are taken for sRGB");
        return Coding::Srgb(Some(says));
    };
    if curve.is_srgb() {
        return Coding::Srgb(None);
    }
    let says = format!("its gAMA chunk ({stated}) says that its samples are {}", curve.named());
    Coding::Curves { says, curves: vec![curve], narrow: false }
}

fn of_profile(profile: Option<ColorProfile>) -> Coding {
    let Some(ColorProfile { name, curves }) = profile else {
        let says = "its colour profile cannot be read; its samples are taken for sRGB";
        return Coding::Srgb(Some(says.to_owned()));
    };
    let called = name.as_ref().map_or_else(|| "without a name".to_owned(), |name| format!("“{name}”"));
    match curves {
        None => Coding::Srgb(Some(format!(
            "its colour profile is {called}, which has no curve from samples to light; its samples are taken for sRGB. \
             If edges and stripes are displaced, convert it to sRGB"
        ))),
        Some(curves) if curves.iter().all(Curve::is_srgb) => {
            let known = name.is_some_and(|name| name.to_lowercase().contains("srgb"));
            Coding::Srgb((!known).then(|| {
                format!("its colour profile is {called}; its curve is that of sRGB, and colours are taken as they are stored")
            }))
        }
        Some(curves) => Coding::Curves {
            says: format!("its colour profile {called} says that its samples are {}", curves[0].named()),
            curves,
            narrow: false,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::color_profile::tests::{exponent, rgb, srgb_curve};
    use super::*;

    type Chunk<'a> = (&'a [u8; 4], &'a [u8]);

    fn png(chunks: &[Chunk]) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        for (name, content) in chunks {
            bytes.extend((content.len() as u32).to_be_bytes());
            bytes.extend_from_slice(*name);
            bytes.extend_from_slice(content);
            bytes.extend([0; 4]);
        }
        bytes
    }

    /// The only curve that is converted from; `None` for sRGB.
    fn curve(coding: &Coding) -> Option<Curve> {
        match coding {
            Coding::Curves { curves, .. } => curves.first().cloned(),
            _ => None,
        }
    }

    #[test]
    fn the_first_of_cicp_profile_srgb_and_gama_counts() {
        let linear: Chunk = (b"gAMA", &100_000_u32.to_be_bytes());
        let (srgb, bt709): (Chunk, Chunk) = ((b"sRGB", &[0]), (b"cICP", &[1, 1, 0, 1]));
        let adobe = rgb("Adobe RGB (1998)", &exponent(2.2));
        let wide = rgb("ProPhoto RGB", &exponent(1.8));
        let found = |chunks: &[_], profile| coding(Some(&png(chunks)), profile);
        assert_eq!(curve(&found(&[linear], None)), Some(Curve::Power(1.0)));
        assert_eq!(found(&[linear, srgb], None), Coding::Srgb(None));
        assert!(matches!(found(&[linear], Some(&adobe)), Coding::Srgb(Some(says)) if says.contains("Adobe")));
        assert!(
            matches!(found(&[srgb], Some(&wide)), Coding::Curves { says, .. } if says.contains("ProPhoto"))
        );
        assert_eq!(curve(&found(&[linear, srgb, bt709], Some(&adobe))), Some(Curve::Bt709));
        // Unspecified: the next one.
        assert_eq!(curve(&found(&[linear, (b"cICP", &[2, 2, 0, 1])], None)), Some(Curve::Power(1.0)));
        // Behind the picture nothing counts.
        assert_eq!(found(&[(b"IDAT", &[]), linear], None), Coding::Srgb(None));
    }

    #[test]
    fn code_points_and_exponents() {
        let of = |transfer| of_cicp([1, transfer, 0, 1]);
        for (transfer, expected) in
            [(1, Curve::Bt709), (6, Curve::Bt709), (14, Curve::Bt709), (15, Curve::Bt709)]
        {
            assert_eq!(curve(&of(transfer).unwrap()), Some(expected), "{transfer}");
        }
        assert_eq!(curve(&of(5).unwrap()), Some(Curve::Power(2.8)));
        assert_eq!(curve(&of(8).unwrap()), Some(Curve::Linear));
        // 2.2 and sRGB are one.
        assert_eq!([of(13), of(4)], [Some(Coding::Srgb(None)), Some(Coding::Srgb(None))]);
        assert!(matches!(of_cicp([1, 13, 0, 0]), Some(Coding::Curves { narrow: true, .. })));
        assert_eq!(of(16), Some(Coding::Refused("PQ (HDR)")));
        assert_eq!(of(18), Some(Coding::Refused("HLG (HDR)")));
        assert!(matches!(of(17), Some(Coding::Srgb(Some(_)))) && of(2).is_none());
        assert_eq!(of_gamma(45_455), Coding::Srgb(None));
        for nonsense in [0, 1, u32::MAX] {
            assert!(matches!(of_gamma(nonsense), Coding::Srgb(Some(_))), "{nonsense}");
        }
    }

    #[test]
    fn profiles_are_told_unless_they_are_srgb() {
        let says = |name: &str, curve: &[u8]| match coding(None, Some(&rgb(name, curve))) {
            Coding::Srgb(says) => says,
            other => panic!("{other:?}"),
        };
        assert_eq!(says("sRGB IEC61966-2.1", &srgb_curve()), None);
        assert!(says("Display P3", &srgb_curve()).unwrap().contains("Display P3"));
        assert!(
            matches!(coding(None, Some(b"no profile")), Coding::Srgb(Some(says)) if says.contains("cannot"))
        );
    }
}
