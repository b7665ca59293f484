//! Options whose values have names: the command, the bindings and files spell them as they print and parse themselves.

use crate::error::Error;

/// What a text that names no value is answered with; `more` says what is accepted beside the names.
pub(crate) fn unnamed(what: &'static str, names: &[&str], more: &str, found: &str) -> Error {
    // A file may have been given for a word.
    let found: String = found.chars().take(40).collect();
    Error::invalid(what, format!("{}{more}", names.join(", ")), format!("\"{found}\""))
}

/// Gives an enum without data its names: `NAMES`, `name`, `Display` and `FromStr` (in capitals or not).
macro_rules! named {
    ($type:ident, $what:literal, { $($value:ident => $name:literal),+ $(,)? }) => {
        impl $type {
            /// All values, in the order of [`NAMES`](Self::NAMES).
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$value),+];
            /// The names of all values.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// Its name on the command line, in files and in Python.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $name),+
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = crate::error::Error;

            /// # Errors
            /// [`Error::Invalid`](crate::error::Error::Invalid) that lists the names.
            fn from_str(text: &str) -> crate::error::Result<Self> {
                let given = text.to_ascii_lowercase();
                let known = Self::ALL.into_iter().find(|value| value.name() == given);
                known.ok_or_else(|| crate::named::unnamed($what, Self::NAMES, "", text))
            }
        }
    };
}
pub(crate) use named;

#[cfg(test)]
mod tests {
    use std::fmt::{Debug, Display};
    use std::str::FromStr;

    use crate::calibrate::{DistortionModel, Method, PrincipalPointRule as Rule};
    use crate::cloud::Frame;
    use crate::error::Error;
    use crate::format::{CloudFormat, ExchangeFormat};
    use crate::geometry::RectangleSize;
    use crate::pattern::Axis;
    use crate::photo::Encoding;
    use crate::reconstruct::CullRule;

    fn round_trip<T: FromStr<Err = Error> + Display + Debug + PartialEq>(values: &[T]) {
        for value in values {
            assert_eq!(value.to_string().parse().as_ref(), Ok(value));
        }
        let error = "nonsense".parse::<T>().unwrap_err().to_string();
        assert!(error.contains("expected") && error.ends_with("found \"nonsense\""), "{error}");
    }

    #[test]
    fn every_option_parses_what_it_prints() {
        round_trip(&Method::ALL);
        round_trip(&DistortionModel::ALL);
        round_trip(&Frame::ALL);
        round_trip(&Axis::ALL);
        round_trip(&CloudFormat::ALL);
        round_trip(&ExchangeFormat::ALL);
        round_trip(&[Rule::Shift, Rule::Prior, Rule::Centre, Rule::Free, Rule::Exact(-3.5, 4.0)]);
        round_trip(&[Encoding::Srgb, Encoding::Linear, Encoding::Gamma(2.2)]);
        round_trip(&[CullRule::Auto, CullRule::Off, CullRule::MaxAreaMm2(25.0)]);
        round_trip(&[RectangleSize { width_mm: 215.9, height_mm: 279.4 }]);
    }

    #[test]
    fn values_outside_their_range_are_refused() {
        for text in ["0.05", "11", "nan", "-1", ""] {
            assert!(text.parse::<Encoding>().is_err(), "{text}");
        }
        for text in ["0", "-1", "inf", "nan", "1,2"] {
            assert!(text.parse::<CullRule>().is_err(), "{text}");
        }
        for text in ["1", "1,2,3", "1,nan", "inf,2"] {
            assert!(text.parse::<Rule>().is_err(), "{text}");
        }
        assert_eq!("center".parse(), Ok(Rule::Centre));
    }
}
