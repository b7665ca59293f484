//! Sensors of common cameras that do not state the 35 mm equivalent of their focal length, by `Make` and `Model`.
//!
//! The sizes are the image areas of the makers' specifications, rounded to what a family of cameras shares; differences
//! within a family are below 2 %.

/// The image area of a sensor, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sensor {
    pub(super) width_mm: f64,
    pub(super) height_mm: f64,
}

const fn sensor_of(width_mm: f64, height_mm: f64) -> Sensor {
    Sensor { width_mm, height_mm }
}

const FULL_FRAME: Sensor = sensor_of(36.0, 24.0);
const APS_H: Sensor = sensor_of(28.1, 18.7);
const APS_C: Sensor = sensor_of(23.6, 15.7);
const APS_C_CANON: Sensor = sensor_of(22.3, 14.9);
const FOUR_THIRDS: Sensor = sensor_of(17.3, 13.0);
/// Called "1 inch".
const ONE_INCH: Sensor = sensor_of(13.2, 8.8);
/// Called "2/3 inch".
const TWO_THIRDS_INCH: Sensor = sensor_of(8.8, 6.6);
/// Called "1/1.7 inch".
const COMPACT_LARGE: Sensor = sensor_of(7.44, 5.58);
/// Called "1/2.3 inch".
const COMPACT: Sensor = sensor_of(6.17, 4.55);

/// A maker, the beginning of what it writes as `Model` after its name, and the sensor. The longest beginning that ends where
/// a word ends decides, or where the table's ends with `*`.
const CAMERAS: &[(&str, &[&str], Sensor)] = &[
    // Specifications at canon.com ("Canon Camera Museum"); US names of the same bodies are below.
    (
        "CANON",
        &[
            "EOS 5D", "EOS 5DS", "EOS 6D", "EOS-1DS", "EOS-1D X", "EOS-1D C", "EOS R", "EOS R1", "EOS R3",
            "EOS R5", "EOS R5M2", "EOS R6", "EOS R6M2", "EOS R8", "EOS RP",
        ],
        FULL_FRAME,
    ),
    ("CANON", &["EOS-1D", "EOS-1D MARK II", "EOS-1D MARK III", "EOS-1D MARK IV"], APS_H),
    (
        "CANON",
        &[
            "EOS 7D",
            "EOS 10D",
            "EOS 20D",
            "EOS 30D",
            "EOS 40D",
            "EOS 50D",
            "EOS 60D",
            "EOS 70D",
            "EOS 77D",
            "EOS 80D",
            "EOS 90D",
            "EOS 100D",
            "EOS 200D",
            "EOS 250D",
            "EOS 300D",
            "EOS 350D",
            "EOS 400D",
            "EOS 450D",
            "EOS 500D",
            "EOS 550D",
            "EOS 600D",
            "EOS 650D",
            "EOS 700D",
            "EOS 750D",
            "EOS 760D",
            "EOS 800D",
            "EOS 850D",
            "EOS 1000D",
            "EOS 1100D",
            "EOS 1200D",
            "EOS 1300D",
            "EOS 1500D",
            "EOS 2000D",
            "EOS 3000D",
            "EOS 4000D",
            "EOS 8000D",
            "EOS 9000D",
            "EOS DIGITAL REBEL",
            "EOS REBEL",
            "EOS KISS",
            "EOS M",
            "EOS M2",
            "EOS M3",
            "EOS M5",
            "EOS M6",
            "EOS M10",
            "EOS M50",
            "EOS M50M2",
            "EOS M100",
            "EOS M200",
            "EOS R7",
            "EOS R10",
            "EOS R50",
            "EOS R100",
            "EOS D30",
            "EOS D60",
            "POWERSHOT G1 X MARK III",
        ],
        APS_C_CANON,
    ),
    ("CANON", &["POWERSHOT G1 X", "POWERSHOT G1 X MARK II"], sensor_of(18.7, 14.0)),
    ("CANON", &["POWERSHOT G3 X", "POWERSHOT G5 X", "POWERSHOT G7 X", "POWERSHOT G9 X"], ONE_INCH),
    (
        "CANON",
        &[
            "POWERSHOT G9",
            "POWERSHOT G10",
            "POWERSHOT G11",
            "POWERSHOT G12",
            "POWERSHOT G15",
            "POWERSHOT G16",
            "POWERSHOT S90",
            "POWERSHOT S95",
            "POWERSHOT S100",
            "POWERSHOT S110",
            "POWERSHOT S120",
            "POWERSHOT S200",
        ],
        COMPACT_LARGE,
    ),
    ("CANON", &["POWERSHOT G7", "POWERSHOT A650 IS", "POWERSHOT A640"], sensor_of(7.18, 5.32)),
    ("CANON", &["POWERSHOT SX*"], COMPACT),
    ("CANON", &["POWERSHOT SX100 IS", "POWERSHOT SX120 IS"], sensor_of(5.76, 4.29)),
    // Specifications at imaging.nikon.com.
    (
        "NIKON",
        &[
            "D3", "D3S", "D3X", "D4", "D4S", "D5", "D6", "D600", "D610", "D700", "D750", "D780", "D800",
            "D800E", "D810", "D810A", "D850", "DF", "Z 5", "Z 6", "Z 7", "Z 8", "Z 9", "Z F", "Z 5_2",
            "Z 6_2", "Z 6_3", "Z 7_2",
        ],
        FULL_FRAME,
    ),
    (
        "NIKON",
        &[
            "D1",
            "D1H",
            "D1X",
            "D2H",
            "D2X",
            "D2XS",
            "D40",
            "D40X",
            "D50",
            "D60",
            "D70",
            "D70S",
            "D80",
            "D90",
            "D100",
            "D200",
            "D300",
            "D300S",
            "D500",
            "D3000",
            "D3100",
            "D3200",
            "D3300",
            "D3400",
            "D3500",
            "D5000",
            "D5100",
            "D5200",
            "D5300",
            "D5500",
            "D5600",
            "D7000",
            "D7100",
            "D7200",
            "D7500",
            "Z 30",
            "Z 50",
            "Z50_2",
            "Z FC",
            "COOLPIX A",
        ],
        APS_C,
    ),
    ("NIKON", &["1 J*", "1 V*", "1 S*", "1 AW*"], ONE_INCH),
    // Specifications at sony.com.
    (
        "SONY",
        &[
            "ILCE-7*",
            "ILCE-9*",
            "ILCE-1",
            "ILCE-1M2",
            "ILME-FX3",
            "DSLR-A850",
            "DSLR-A900",
            "SLT-A99*",
            "DSC-RX1*",
        ],
        FULL_FRAME,
    ),
    (
        "SONY",
        &["ILCE-3*", "ILCE-5*", "ILCE-6*", "ZV-E10*", "NEX-*", "SLT-A*", "DSLR-A*", "ILCA-68", "ILCA-77M2"],
        APS_C,
    ),
    ("SONY", &["ILCA-99M2"], FULL_FRAME),
    ("SONY", &["DSC-RX10", "DSC-RX10M*", "DSC-RX100*", "ZV-1*"], ONE_INCH),
    // Specifications at fujifilm-x.com.
    (
        "FUJIFILM",
        &["X-T*", "X-E*", "X-PRO*", "X-A*", "X-M*", "X-H*", "X-S10", "X-S20", "X100*", "X70", "XF10"],
        APS_C,
    ),
    ("FUJIFILM", &["GFX*"], sensor_of(43.8, 32.9)),
    ("FUJIFILM", &["X10", "X20", "X30", "XF1", "X-S1"], TWO_THIRDS_INCH),
    // Specifications at panasonic.com, and of the standard (four-thirds.org).
    ("PANASONIC", &["DMC-G*", "DC-G*", "DMC-L1", "DMC-L10"], FOUR_THIRDS),
    ("PANASONIC", &["DC-S1*", "DC-S5*", "DC-S9*"], FULL_FRAME),
    ("PANASONIC", &["DMC-FZ1000", "DC-FZ1000M2", "DMC-FZ2000", "DMC-FZ2500"], ONE_INCH),
    ("OLYMPUS", &["E-*", "PEN-F"], FOUR_THIRDS),
    ("OM DIGITAL SOLUTIONS", &["OM-*"], FOUR_THIRDS),
    // Specifications at us.ricoh-imaging.com.
    ("PENTAX", &["K-1"], FULL_FRAME),
    ("PENTAX", &["K-*", "*IST*", "K10D", "K20D", "K100D*", "K110D", "K200D", "KP", "KF"], APS_C),
    ("RICOH", &["GR", "GR II", "GR III*"], APS_C),
    // Specifications at leica-camera.com.
    ("LEICA", &["M9*", "M10*", "M11*", "M MONOCHROM", "LEICA Q*", "Q*", "SL*"], FULL_FRAME),
];

/// Camera modules for boards, whose `Model` contains the name of the sensor: pixels times their pitch, from the sensors' data
/// sheets (raspberrypi.com lists them). Widths hold for still pictures, which use the whole sensor.
const MODULES: [(&str, Sensor); 6] = [
    ("OV5647", sensor_of(3.63, 2.72)),
    ("IMX219", sensor_of(3.67, 2.76)),
    ("IMX296", sensor_of(5.02, 3.75)),
    ("IMX477", sensor_of(6.29, 4.71)),
    ("IMX500", sensor_of(6.29, 4.71)),
    ("IMX708", sensor_of(6.45, 3.63)),
];

/// The sensor of a camera, if the table has it.
pub(super) fn sensor(make: Option<&str>, model: &str) -> Option<Sensor> {
    let (make, model) = (normalized(make.unwrap_or_default()), normalized(model));
    if let Some((_, sensor)) = MODULES.iter().find(|(name, _)| model.contains(name)) {
        return Some(*sensor);
    }
    let mut best: Option<(usize, Sensor)> = None;
    for (maker, beginnings, sensor) in CAMERAS {
        // Some write their name into both tags, some into one.
        let own = model.strip_prefix(maker).map(|m| m.trim_start_matches([' ', '_']));
        let Some(name) = own.or_else(|| make.starts_with(maker).then_some(model.as_str())) else { continue };
        for beginning in beginnings.iter().filter(|b| matches(name, b)) {
            if best.is_none_or(|(length, _)| beginning.len() > length) {
                best = Some((beginning.len(), *sensor));
            }
        }
    }
    best.map(|(_, sensor)| sensor)
}

/// Whether a name has this beginning, up to the end of a word unless it ends with `*`.
fn matches(name: &str, beginning: &str) -> bool {
    match beginning.strip_suffix('*') {
        Some(open) => name.starts_with(open),
        None => name.strip_prefix(beginning).is_some_and(|rest| rest.is_empty() || rest.starts_with(' ')),
    }
}

/// Upper case, without surplus spaces and what ends texts in files.
fn normalized(text: &str) -> String {
    let words: Vec<&str> =
        text.split(|c: char| c.is_whitespace() || c == '\0').filter(|w| !w.is_empty()).collect();
    words.join(" ").to_uppercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn width(make: &str, model: &str) -> Option<f64> {
        sensor(Some(make), model).map(|s| s.width_mm)
    }

    #[test]
    fn cameras_are_found_as_they_write_their_names() {
        assert_eq!(width("Canon", "Canon PowerShot G10"), Some(7.44));
        assert_eq!(sensor(None, "Canon PowerShot G10\0").map(|s| s.width_mm), Some(7.44));
        assert_eq!(width("Canon", "Canon EOS 5D Mark III"), Some(36.0));
        assert_eq!(width("Canon", "Canon EOS 50D"), Some(22.3));
        assert_eq!(width("Canon", "Canon EOS REBEL T3i"), Some(22.3));
        assert_eq!(width("Canon", "Canon EOS-1D Mark IV"), Some(28.1));
        assert_eq!(width("Canon", "Canon EOS-1D X Mark II"), Some(36.0));
        assert_eq!(width("Canon", "Canon EOS-1Ds Mark III"), Some(36.0));
        assert_eq!(width("Canon", "Canon EOS R50"), Some(22.3));
        assert_eq!(width("Canon", "Canon PowerShot G1 X Mark III"), Some(22.3));
        assert_eq!(width("Canon", "Canon PowerShot SX230 HS"), Some(6.17));
        assert_eq!(width("NIKON CORPORATION", "NIKON D90"), Some(23.6));
        assert_eq!(width("NIKON CORPORATION", "NIKON D850"), Some(36.0));
        assert_eq!(width("NIKON CORPORATION", "NIKON Z 6_2"), Some(36.0));
        assert_eq!(width("SONY", "ILCE-7M3"), Some(36.0));
        assert_eq!(width("SONY", "ILCE-6400"), Some(23.6));
        assert_eq!(width("SONY", "SLT-A99V"), Some(36.0));
        assert_eq!(width("SONY", "DSC-RX100M3"), Some(13.2));
        assert_eq!(width("FUJIFILM", "X-T30 II"), Some(23.6));
        assert_eq!(width("FUJIFILM", "X-S1"), Some(8.8));
        assert_eq!(width("Panasonic", "DC-GH5"), Some(17.3));
        assert_eq!(width("Panasonic", "DMC-FZ1000"), Some(13.2));
        assert_eq!(width("OLYMPUS IMAGING CORP.  ", "E-M10MarkII     "), Some(17.3));
        assert_eq!(width("RaspberryPi", "RP_imx219"), Some(3.67));
        assert_eq!(width("Raspberry Pi", "/base/soc/i2c0mux/i2c@1/imx708@1a"), Some(6.45));
    }

    #[test]
    fn other_cameras_are_not_guessed() {
        assert_eq!(width("Canon", "Canon EOS 6000D"), None);
        assert_eq!(width("Canon", ""), None);
        assert_eq!(width("", "D90"), None);
        assert_eq!(width("Apple", "iPhone 12"), None);
        assert_eq!(width("SONY", "D3"), None);
    }

    #[test]
    fn the_table_holds_each_camera_once_and_plausible_sensors() {
        let mut names = Vec::new();
        for (maker, beginnings, sensor) in CAMERAS {
            assert!((4.0..45.0).contains(&sensor.width_mm), "{maker}");
            assert!((1.3..1.8).contains(&(sensor.width_mm / sensor.height_mm)), "{maker} {sensor:?}");
            names.extend(beginnings.iter().map(|b| (maker, *b)));
        }
        for (i, (maker, name)) in names.iter().enumerate() {
            assert_eq!(*name, name.to_uppercase());
            assert!(!names[..i].contains(&(maker, name)), "{maker} {name}");
        }
    }
}
