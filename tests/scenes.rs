//! Small scenes made in code, for tests of the renderer.

use furrier::data::camera::Camera;
use furrier::data::fields::Fields;
use furrier::data::light::Directional;
use furrier::data::mesh::{Mesh, position_classes};
use furrier::data::strands::Strands;
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Colour, Guard, Length, Shape, Undercoat};
use furrier::fur::grow::skin;
use furrier::math::{DVec3, Vec3};
use furrier::shade::fibre::{Fibres, Film};
use furrier::stage::projection::Projection;
use furrier::volume::scene::{HairScattering, Lighting, Scene};
use std::sync::LazyLock;

/// Both kinds of hair of the default fibre.
pub fn scattering() -> &'static HairScattering {
    static DEFAULT: LazyLock<HairScattering> =
        LazyLock::new(|| HairScattering::new(&Fibres::default(), &Film::default()).unwrap());
    &DEFAULT
}

/// Skin and hair that a [`Scene`] borrows.
pub struct Grown {
    pub mesh: Mesh,
    pub fields: Fields,
    pub guard_fibre: Fibre,
    pub undercoat_fibre: Fibre,
    pub guard: Strands,
}

impl Grown {
    /// Grows guard hair on a mesh whose hair leans `lean_deg` towards `comb`.
    pub fn new(mesh: Mesh, guard: &Guard, undercoat: &Undercoat, comb: Vec3, lean_deg: f32, seed: u64) -> Self {
        let n = mesh.positions_m.len();
        let normals = mesh.smooth_normals();
        let direction: Vec<Vec3> = normals.iter().map(|&n| (comb - n * comb.dot(n)).normalize_or_zero()).collect();
        let (sin, cos) = lean_deg.to_radians().sin_cos();
        let lean = normals.iter().zip(&direction).map(|(&n, &d)| (n * cos + d * sin).normalize()).collect();
        let fields = Fields {
            length: vec![1.0; n],
            density: vec![1.0; n],
            direction,
            lean,
            clump: vec![1.0; n],
            tint: vec![Vec3::from(Colour::default().tint); n],
            paint: None,
            partings: Vec::new(),
        };
        let colour = Colour::default();
        let guard_fibre = Fibre::guard(guard, &colour, 1.0);
        let undercoat_fibre = Fibre::undercoat(undercoat, &colour, 1.0);
        let guard = skin::grow(&guard_fibre, &mesh, &fields, seed);
        Self { mesh, fields, guard_fibre, undercoat_fibre, guard }
    }

    /// With guard hair and undercoat.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            skin: &self.mesh,
            fields: &self.fields,
            skin_factor: Vec3::splat(0.5),
            guard: Some((&self.guard, &self.guard_fibre)),
            undercoat: Some(&self.undercoat_fibre),
            scattering: scattering(),
        }
    }
}

/// A mesh over a grid of `u` × `v` quads; `place` maps [0, 1]² to the surface.
pub fn grid(u: usize, v: usize, place: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let mut positions_m = Vec::new();
    for j in 0..=v {
        for i in 0..=u {
            positions_m.push(place(i as f32 / u as f32, j as f32 / v as f32));
        }
    }
    let at = |i: usize, j: usize| (j * (u + 1) + i) as u32;
    let mut triangles = Vec::new();
    for j in 0..v {
        for i in 0..u {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let position_class = position_classes(&positions_m, 1e-6);
    let mut mesh =
        Mesh { normals: vec![Vec3::Y; positions_m.len()], positions_m, triangles, position_class, ..Mesh::default() };
    // Poles and seams: triangles whose corners are one point have no area and no side.
    mesh.triangles.retain(|t| {
        let [a, b, c] = t.map(|v| mesh.position_class[v as usize]);
        a != b && b != c && c != a
    });
    mesh.normals = mesh.smooth_normals();
    mesh
}

/// Half a cylinder lying along x, open at its borders: 3,584 triangles and 190 cm² at `detail` 1.
pub fn bent_skin(detail: usize) -> Mesh {
    let (radius, length) = (0.04, 0.15);
    grid(56 * detail, 32 * detail, |u, v| {
        let angle = std::f32::consts::PI * v;
        Vec3::new((u - 0.5) * length, radius * angle.sin(), radius * angle.cos())
    })
}

/// About mink: 20,000 hairs per cm², one in thirty a guard hair.
pub fn mink() -> (Guard, Undercoat) {
    let shape = Shape { length_variation: 0.15, bend_deg: 25.0, jitter_deg: 7.0, noise: 0.02, ..Shape::default() };
    let guard = Guard {
        density_per_cm2: 650.0,
        length: Length::Mm(21.0),
        diameter_um: 110.0,
        taper: 0.1,
        tip_transparency: 0.6,
        shape,
    };
    let undercoat = Undercoat {
        density_per_cm2: 19_350.0,
        length: Length::Mm(12.0),
        diameter_um: 14.0,
        shape: Shape { length_variation: 0.15, jitter_deg: 10.0, ..Shape::default() },
    };
    (guard, undercoat)
}

/// A key light from above left, a little light from everywhere.
pub fn studio() -> Lighting {
    Lighting {
        key: Directional::travelling(Vec3::new(1.0, -1.6, -0.8), Vec3::splat(6.0)).unwrap().into(),
        fill: Vec::new(),
        ambient: Vec3::splat(0.6),
        fill_on_undercoat: false,
    }
}

/// Looks at the origin from `distance_m` away, a little from above.
pub fn camera(distance_m: f32) -> Camera {
    looking(Vec3::new(0.35, 0.55, 0.76).normalize() * distance_m, Vec3::ZERO, Vec3::Y, 34.0)
}

/// Looks from one point at another.
pub fn looking(eye_m: Vec3, target_m: Vec3, up: Vec3, vfov_deg: f64) -> Camera {
    let [eye, target, up] = [eye_m, target_m, up].map(|v| v.as_dvec3().to_array());
    Camera { eye, target, up, vfov_deg }
}

/// What a camera sees in a picture of `size`, world coordinates.
pub fn view(camera: &Camera, size: [usize; 2]) -> Projection {
    Projection::new(camera, DVec3::ZERO, size).unwrap()
}
