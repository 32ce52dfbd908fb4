//! What is drawn through a view. Pixels are samples here: the film averages them.

use crate::data::strands::Strands;
use crate::hybrid::flat::Flat;
use crate::hybrid::guard_light::GuardShader;
use crate::hybrid::prepared::Prepared;
use crate::hybrid::settings::Settings;
use crate::hybrid::skin::{NONE, SkinTile};
use crate::hybrid::strands::RibbonPoint;
use crate::hybrid::strands::thin::Thinning;
use crate::hybrid::undercoat_light::UndercoatShader;
use crate::math::lanes::Vec3Row;
use crate::math::table::Table;
use crate::math::{Vec2, Vec3};
use crate::stage::projection::Projection;
use crate::volume::bins::{Bins, Reach};
use crate::volume::march::shadows::Shadows;

/// What is drawn, and through which view.
pub(super) struct Pass<'a> {
    pub(super) prepared: &'a Prepared<'a>,
    pub(super) view: Projection,
    pub(super) settings: &'a Settings,
    pub(super) thinning: Thinning,
    /// The skin's vertices in camera axes.
    pub(super) skin_camera_m: Vec<Vec3>,
    /// Triangles seen from their bare side.
    pub(super) bare: Vec<bool>,
    pub(super) guard: Option<(&'a Strands, GuardShader<'a>)>,
    pub(super) undercoat: Option<(&'a Shadows<'a>, UndercoatShader<'a>)>,
    /// Opacity of a guard hair along it.
    pub(super) opacity: Table,
    /// One over the segments of a strand.
    pub(super) per_segment: f32,
}

/// The strands of a band, ready to be drawn.
#[derive(Default)]
pub(super) struct StrandBand {
    pub(super) strands: Vec<u32>,
    pub(super) ribbon_points: Vec<RibbonPoint>,
    /// Logarithms of radiance, one row for each strand.
    pub(super) log_radiance: Vec<Vec3Row>,
    /// Source index of each strand.
    pub(super) ids: Vec<u32>,
    pub(super) bins: Bins,
}

/// A tile on a hair that is drawn.
pub(super) struct Hair<'a> {
    /// Ends of the segment it lies on.
    pub(super) a: &'a RibbonPoint,
    pub(super) b: &'a RibbonPoint,
    /// Where between them on the picture, 0 to 1.
    pub(super) linear: f32,
    /// Its depth along the optical axis, m.
    pub(super) z_m: f32,
}

impl<'a> Pass<'a> {
    pub(super) fn new(prepared: &'a Prepared<'a>, shadows: Option<&'a Shadows<'a>>, view: Projection) -> Self {
        let scene = &prepared.scene;
        let guard = scene.guard.map(|(strands, _)| (strands, GuardShader::new(prepared, strands, shadows, view.eye_m)));
        let skin_camera_m: Vec<Vec3> = scene.skin.positions_m.iter().map(|&p| view.camera_from_world(p)).collect();
        let corners = |triangle: &[u32; 3]| triangle.map(|v| skin_camera_m[v as usize]);
        let bare = scene.skin.triangles.iter().map(|triangle| !Flat::new(corners(triangle)).faces_eye()).collect();
        let undercoat = shadows.map(|shadows| (shadows, UndercoatShader::new(scene, prepared.lighting, view.eye_m)));
        let opacity = Table::new(|s| scene.guard.map_or(1.0, |(strands, _)| strands.profile.opacity_at(s)));
        let segments = scene.guard.map_or(1, |(strands, _)| strands.points_per_strand - 1);
        Self {
            prepared,
            view,
            settings: &prepared.settings,
            thinning: prepared.settings.thinning(&view),
            skin_camera_m,
            bare,
            guard,
            undercoat,
            opacity,
            per_segment: 1.0 / segments as f32,
        }
    }

    pub(super) fn corners(&self, t: u32) -> [Vec3; 3] {
        self.prepared.scene.skin.triangles[t as usize].map(|v| self.skin_camera_m[v as usize])
    }

    /// Columns and rows of pixels whose middles may lie in `reach`.
    pub(super) fn pixels(&self, reach: &Reach) -> [std::ops::Range<usize>; 2] {
        [0, 1].map(|axis| {
            let size = self.view.size[axis];
            let from = (reach.from[axis] - 0.5).ceil().max(0.0) as usize;
            let to = ((reach.to[axis] - 0.5).floor() + 1.0).max(0.0) as usize;
            from.min(size)..to.min(size)
        })
    }

    /// Whether a hair lies before the skin. On slanting skin, half of the roots lie behind the skin of the pixel's middle:
    /// they count where they lie before the skin of their own tile. Seen from its bare side, skin hides what lies behind
    /// either.
    #[inline(always)]
    pub(super) fn before_skin(&self, hair: &Hair<'_>, pixel: [i32; 2], skin: &SkinTile, at: usize) -> bool {
        let z_m = hair.z_m;
        let (triangle, before_middle) = (skin.triangle[at], z_m < skin.z_m[at]);
        // Planes are asked for only where they decide.
        if triangle == NONE || before_middle != self.bare[triangle as usize] {
            return before_middle;
        }
        self.before_plane(hair, pixel, triangle)
    }

    /// Whether a hair lies before the plane of a triangle, at its own tile within the pixel.
    #[inline(never)]
    fn before_plane(&self, &Hair { a, b, linear, z_m }: &Hair<'_>, pixel: [i32; 2], triangle: u32) -> bool {
        let at = |from: f32, to: f32, pixel: i32| (from + linear * (to - from)).clamp(pixel as f32, (pixel + 1) as f32);
        let pixel = Vec2::new(at(a.x, b.x, pixel[0]), at(a.y, b.y, pixel[1]));
        let ray = ((pixel - self.view.centre_px) / self.view.focal_px).extend(1.0);
        z_m < Flat::new(self.corners(triangle)).plane_depth(ray)
    }
}
