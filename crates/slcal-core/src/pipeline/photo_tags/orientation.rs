//! How a photograph was turned upright, and how to turn coordinates from one frame to another.

use nalgebra::Point2;

/// The EXIF tag `Orientation`: how the stored pixels are turned to be upright.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Orientation {
    /// 1: as stored.
    #[default]
    AsStored,
    /// 2.
    Mirrored,
    /// 3: by half a turn.
    HalfTurn,
    /// 4.
    MirroredHalfTurn,
    /// 5.
    MirroredLeft,
    /// 6: by a quarter turn clockwise.
    Right,
    /// 7.
    MirroredRight,
    /// 8: by a quarter turn counterclockwise.
    Left,
}

impl Orientation {
    const ALL: [Self; 8] = [
        Self::AsStored,
        Self::Mirrored,
        Self::HalfTurn,
        Self::MirroredHalfTurn,
        Self::MirroredLeft,
        Self::Right,
        Self::MirroredRight,
        Self::Left,
    ];

    /// By the value of the tag; values that the standard does not know count as 1.
    #[must_use]
    pub fn of_tag(value: u16) -> Self {
        let index = usize::from(value).wrapping_sub(1);
        Self::ALL.get(index).copied().unwrap_or_default()
    }

    /// The value of the tag, 1 to 8.
    #[must_use]
    pub fn tag(self) -> u16 {
        self as u16 + 1
    }

    /// Quarter turns clockwise; `None` for mirrored ones, which no camera writes.
    fn quarters(self) -> Option<u8> {
        match self {
            Self::AsStored => Some(0),
            Self::Right => Some(1),
            Self::HalfTurn => Some(2),
            Self::Left => Some(3),
            _ => None,
        }
    }

    /// What turns a photograph that was turned upright by `self` so that it lies as if by `other`: stored alike, both then
    /// lie alike.
    pub(in crate::pipeline) fn turn_to(self, other: Self) -> Option<Turn> {
        if self == other {
            return Some(Turn(0));
        }
        Some(Turn((other.quarters()? + 4 - self.quarters()?) % 4))
    }
}

/// Quarter turns of a picture, clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::pipeline) struct Turn(pub(in crate::pipeline) u8);

impl Turn {
    /// Width and height of a turned picture.
    pub(in crate::pipeline) fn size(self, [w, h]: [u32; 2]) -> [u32; 2] {
        if self.is_sideways() { [h, w] } else { [w, h] }
    }

    /// Whether width and height are exchanged.
    pub(in crate::pipeline) fn is_sideways(self) -> bool {
        self.0 % 2 == 1
    }

    /// Where a pixel of a picture of this size lies once the picture is turned.
    pub(in crate::pipeline) fn point(self, p: Point2<f64>, [w, h]: [u32; 2]) -> Point2<f64> {
        let (right, bottom) = (f64::from(w) - 1.0, f64::from(h) - 1.0);
        match self.0 % 4 {
            0 => p,
            1 => Point2::new(bottom - p.y, p.x),
            2 => Point2::new(right - p.x, bottom - p.y),
            _ => Point2::new(p.y, right - p.x),
        }
    }
}

#[cfg(test)]
mod tests {
    use image::metadata::Orientation as Stored;
    use image::{DynamicImage, GenericImageView, GrayImage, Luma};

    use super::*;

    /// Every pixel has a value of its own.
    fn picture() -> DynamicImage {
        DynamicImage::ImageLuma8(GrayImage::from_fn(5, 3, |x, y| Luma([(10 * y + x) as u8])))
    }

    fn upright(tag: u16) -> DynamicImage {
        let mut turned = picture();
        turned.apply_orientation(Stored::from_exif(tag as u8).unwrap());
        turned
    }

    #[test]
    fn tags_there_and_back() {
        for tag in 1..=8 {
            assert_eq!(Orientation::of_tag(tag).tag(), tag);
        }
        assert_eq!([0, 9, 65535].map(Orientation::of_tag), [Orientation::AsStored; 3]);
    }

    #[test]
    fn turned_coordinates_lie_where_the_image_library_puts_the_pixels() {
        for (from, to) in [1, 3, 6, 8].into_iter().flat_map(|a| [1, 3, 6, 8].map(|b| (a, b))) {
            let (here, there) = (upright(from), upright(to));
            let turn = Orientation::of_tag(from).turn_to(Orientation::of_tag(to)).unwrap();
            let size = [here.width(), here.height()];
            assert_eq!(turn.size(size), [there.width(), there.height()]);
            for (x, y, value) in here.pixels() {
                let p = turn.point(Point2::new(f64::from(x), f64::from(y)), size);
                assert_eq!(there.get_pixel(p.x as u32, p.y as u32), value, "{from} to {to}: {x},{y}");
            }
        }
    }

    #[test]
    fn mirrored_pictures_are_left_alone() {
        let of = Orientation::of_tag;
        assert_eq!(of(2).turn_to(of(1)), None);
        assert_eq!(of(5).turn_to(of(5)), Some(Turn(0)));
    }
}
