//! Which parameters are unknown and where they stand in the vector of unknowns. A new unknown is added here, to its
//! [`parameter`](crate::parameter), and to the step of [`Model`](super::Model).

use super::assumptions::{Assumptions, Lens};
use super::residual::{BEND, LENS, POSE};
use crate::parameter::{LensParameter, Parameter, PoseParameter};

/// Number of parameters that all views share: both lenses, and the transform between the devices.
pub(crate) const SHARED: usize = 2 * LENS + POSE;

/// Positions in the vector of unknowns: camera, projector, transform between them, view after view. Focal lengths stand
/// there as ln f.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unknowns {
    lenses: [[Option<usize>; LENS]; 2],
    projector_from_camera: Option<usize>,
    /// Number of unknowns that all views share; those of the views follow.
    pub(crate) shared: usize,
    /// Whether the sheets may bend.
    bends: bool,
    views: usize,
}

impl Unknowns {
    /// The unknowns of `views` views under assumptions, with or without a projector.
    pub(crate) fn new(assumptions: &Assumptions, with_projector: bool, views: usize) -> Self {
        Self::of(with_projector, views, !assumptions.flatness.is_flat(), |lens, p| {
            assumptions.estimates(lens, p)
        })
    }

    /// All parameters of both devices and of `views` views, whose sheets are flat or may bend.
    pub(crate) fn all(views: usize, bends: bool) -> Self {
        Self::of(true, views, bends, |_, _| true)
    }

    fn of(
        with_projector: bool,
        views: usize,
        bends: bool,
        estimated: impl Fn(Lens, LensParameter) -> bool,
    ) -> Self {
        let mut count = 0;
        let mut position = |lens, parameter| {
            let active = (lens == Lens::Camera || with_projector) && estimated(lens, parameter);
            active.then(|| {
                count += 1;
                count - 1
            })
        };
        let lenses = Lens::ALL.map(|lens| LensParameter::ALL.map(|p| position(lens, p)));
        let projector_from_camera = with_projector.then_some(count);
        let shared = count + if with_projector { POSE } else { 0 };
        Self { lenses, projector_from_camera, shared, bends, views }
    }

    /// The same unknowns with another number of views.
    pub(crate) fn with_views(&self, views: usize) -> Self {
        Self { views, ..self.clone() }
    }

    /// Number of views.
    pub(crate) fn views(&self) -> usize {
        self.views
    }

    /// Number of unknowns.
    pub(crate) fn len(&self) -> usize {
        self.view(self.views)
    }

    /// Position of a parameter of a lens; `None` for what is held fixed.
    pub(crate) fn lens(&self, lens: Lens, parameter: LensParameter) -> Option<usize> {
        self.lenses[lens as usize][parameter as usize]
    }

    /// Where the transform between the devices begins.
    pub(crate) fn projector_from_camera(&self) -> Option<usize> {
        self.projector_from_camera
    }

    /// Number of unknowns of a view: the pose, and the bend of a sheet that may.
    pub(crate) fn width(&self) -> usize {
        POSE + if self.bends { BEND } else { 0 }
    }

    /// Where view `i` begins.
    pub(crate) fn view(&self, i: usize) -> usize {
        self.shared + self.width() * i
    }

    /// Where the bend of view `i` begins; `None` for flat sheets.
    pub(crate) fn bend(&self, i: usize) -> Option<usize> {
        self.bends.then(|| self.view(i) + POSE)
    }

    /// Position of a parameter; `None` for what is held fixed or not known.
    pub(crate) fn position(&self, parameter: &Parameter) -> Option<usize> {
        match *parameter {
            Parameter::Camera(p) => self.lens(Lens::Camera, p),
            Parameter::Projector(p) => self.lens(Lens::Projector, p),
            Parameter::ProjectorFromCamera(p) => self.projector_from_camera.map(|at| at + p as usize),
            Parameter::View(i, p) => (i < self.views).then(|| self.view(i) + p as usize),
            Parameter::Bend(i, k) => self.bend(i).filter(|_| i < self.views && k < BEND).map(|at| at + k),
            Parameter::Other(_) => None,
        }
    }

    /// The unknowns in order.
    pub(crate) fn parameters(&self) -> Vec<Parameter> {
        let of_lens = |lens: Lens| {
            let active = LensParameter::ALL.into_iter().filter(move |p| self.lens(lens, *p).is_some());
            active.map(
                move |p| if lens == Lens::Camera { Parameter::Camera(p) } else { Parameter::Projector(p) },
            )
        };
        let between = self.projector_from_camera.iter().flat_map(|_| PoseParameter::ALL);
        let bend = if self.bends { BEND } else { 0 };
        let of_view = move |i| {
            let pose = PoseParameter::ALL.into_iter().map(move |p| Parameter::View(i, p));
            pose.chain((0..bend).map(move |k| Parameter::Bend(i, k)))
        };
        let views = (0..self.views).flat_map(of_view);
        let shared =
            Lens::ALL.into_iter().flat_map(of_lens).chain(between.map(Parameter::ProjectorFromCamera));
        shared.chain(views).collect()
    }
}
