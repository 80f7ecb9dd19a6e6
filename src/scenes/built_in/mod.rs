//! The scenes of the command line. A new one is a file here, and its name in the lists of modules, of erased scenes and of [`all`].

mod andrews;
mod box_tube_pendulum;
mod bricard;
mod car_axis;
mod chain;
mod double_pendulum;
mod five_bar;
mod flexible_four_bar;
mod flexible_pendulum;
mod flyball_governor;
mod flying_rod;
mod free_body;
mod gear_train;
mod heavy_top;
mod pendulum;
mod plate_pendulum;
mod princeton_beam;
mod right_angle_cantilever;
mod rigid_spring_beam;
mod screw;
mod slider_crank;
mod spatial_slider_crank;
mod spin_up_beam;
mod suspension;
mod two_four_bar;
mod universal_shaft;
mod von_mises_truss;

pub use andrews::Andrews;
pub use box_tube_pendulum::BoxTubePendulum;
pub use bricard::Bricard;
pub use car_axis::CarAxis;
pub use chain::{Chain, ChainVariables};
pub use double_pendulum::DoublePendulum;
pub use five_bar::FiveBar;
pub use flexible_four_bar::FlexibleFourBar;
pub use flexible_pendulum::FlexiblePendulum;
pub use flyball_governor::FlyballGovernor;
pub use flying_rod::FlyingRod;
pub use free_body::FreeBody;
pub use gear_train::GearTrain;
pub use heavy_top::HeavyTop;
pub use pendulum::Pendulum;
pub use plate_pendulum::{PlatePendulum, Thicknesses};
pub use princeton_beam::PrincetonBeam;
pub use right_angle_cantilever::RightAngleCantilever;
pub use rigid_spring_beam::RigidSpringBeam;
pub use screw::Screw;
pub use slider_crank::SliderCrank;
pub use spatial_slider_crank::SpatialSliderCrank;
pub use spin_up_beam::SpinUpBeam;
pub use suspension::Suspension;
pub use two_four_bar::TwoFourBar;
pub use universal_shaft::UniversalShaft;
pub use von_mises_truss::VonMisesTruss;

use super::AnyScene;

/// Erases scenes by functions that are compiled in this crate: others then compile none of them again.
macro_rules! erased_here {
    ($($scene:ty),* $(,)?) => {$(
        impl AsRef<dyn AnyScene> for $scene {
            #[inline(never)]
            fn as_ref(&self) -> &(dyn AnyScene + 'static) {
                self
            }
        }
    )*};
}

erased_here!(
    Andrews,
    BoxTubePendulum,
    Bricard,
    CarAxis,
    Chain,
    DoublePendulum,
    FiveBar,
    FlexibleFourBar,
    FlexiblePendulum,
    FlyballGovernor,
    FlyingRod,
    FreeBody,
    GearTrain,
    HeavyTop,
    Pendulum,
    PlatePendulum,
    PrincetonBeam,
    RightAngleCantilever,
    RigidSpringBeam,
    Screw,
    SliderCrank,
    SpatialSliderCrank,
    SpinUpBeam,
    Suspension,
    TwoFourBar,
    UniversalShaft,
    VonMisesTruss
);

/// All built-in scenes.
pub fn all() -> Vec<Box<dyn AnyScene>> {
    vec![
        Box::new(Pendulum),
        Box::new(DoublePendulum),
        Box::new(FreeBody),
        Box::new(HeavyTop),
        Box::new(FiveBar),
        Box::new(SliderCrank),
        Box::new(CarAxis),
        Box::new(TwoFourBar),
        Box::new(Andrews),
        Box::new(Bricard),
        Box::new(UniversalShaft),
        Box::new(SpatialSliderCrank),
        Box::new(Screw),
        Box::new(GearTrain),
        Box::new(FlyballGovernor),
        Box::new(FlexibleFourBar::default()),
        Box::new(FlexiblePendulum::default()),
        Box::new(PlatePendulum::default()),
        Box::new(BoxTubePendulum::default()),
        Box::new(RigidSpringBeam),
        Box::new(Suspension::default()),
        Box::new(PrincetonBeam::default()),
        Box::new(SpinUpBeam),
        Box::new(FlyingRod),
        Box::new(RightAngleCantilever::default()),
        Box::new(Chain::common()),
        Box::new(Chain::separate()),
        Box::new(VonMisesTruss),
    ]
}
