//! Shells sampled on the skin, against the strands that grow there.

use crate::accuracy::{fault, print};
use crate::meshes;
use furrier::coat::atlas::judge::{CoatedSkin, SurfacePoint, places, surface_tables};
use furrier::coat::atlas::{AtlasSkin, bake};
use furrier::coat::fins::FinParameters;
use furrier::coat::hair::TileHair;
use furrier::coat::judge::CoverageRow;
use furrier::coat::shells::ShellParameters;
use furrier::coat::tile::TileRecipe;
use furrier::data::coat::{Sampled, Tile};
use furrier::data::fields::Fields;
use furrier::data::mesh::Mesh;
use furrier::data::patches::Patches;
use furrier::data::topology::Topology;
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Colour, Guard, Length, Shape, Undercoat};
use furrier::fur::patch::{Parameterisation, fit_atlas, parameterise};
use furrier::math::{Vec2, Vec3};

const SEED: u64 = 11;

/// A ball with half the density where x > 0, half the length where y > 0, and hair that leans down by 30°.
struct Ball {
    mesh: Mesh,
    fields: Fields,
    hair: [Fibre; 2],
}

impl Ball {
    fn new() -> Self {
        let mesh = meshes::sphere(12, 0.05);
        let normals = mesh.smooth_normals();
        // The fields change over a narrow band, so that each quarter has one value.
        let soft = |v: f32| 0.75 - 0.25 * (v / 0.006).clamp(-1.0, 1.0);
        let comb = meshes::tangent(&mesh, |_| Vec3::NEG_Z);
        let fields = Fields {
            length: mesh.positions_m.iter().map(|p| soft(p.y)).collect(),
            density: mesh.positions_m.iter().map(|p| soft(p.x)).collect(),
            lean: normals.iter().zip(&comb).map(|(n, c)| *n * 0.866 + *c * 0.5).map(Vec3::normalize).collect(),
            direction: comb,
            clump: vec![1.0; mesh.positions_m.len()],
            tint: mesh.positions_m.iter().map(|p| if p.z > 0.0 { Vec3::X } else { Vec3::Y }).collect(),
            paint: None,
            partings: Vec::new(),
        };
        let colour = Colour { variation: 0.0, ..Colour::default() };
        let guard = Guard { density_per_cm2: 150.0, length: Length::Mm(5.0), ..Guard::default() };
        let shape = Shape { jitter_deg: 8.0, ..Shape::default() };
        let undercoat = Undercoat { density_per_cm2: 500.0, length: Length::Mm(3.0), shape, ..Undercoat::default() };
        let hair = [Fibre::guard(&guard, &colour, 1.0), Fibre::undercoat(&undercoat, &colour, 1.0)];
        Self { mesh, fields, hair }
    }

    fn recipe() -> TileRecipe {
        TileRecipe {
            preset: "test".into(),
            shells: ShellParameters { tile_mm: 8.0, ..ShellParameters::default() },
            fins: FinParameters { texture_width: 64, texture_height: 16, thickness_mm: 8.0 },
            skin: Vec3::splat(0.5),
            lean_deg: 30.0,
            looks: None,
            draft: false,
        }
    }

    fn baked(&self, texels: u32) -> (Patches, Tile) {
        let method = Parameterisation::Atlas { texels_per_tile: 64, padding_texels: 4 };
        let mut patches = [parameterise(&self.mesh, &self.fields.direction, 8e-3, method).unwrap()];
        let square = fit_atlas(&mut patches, 8e-3, texels, 4).unwrap();
        let [patches] = patches;
        let skin = AtlasSkin { mesh: &self.mesh, fields: &self.fields, patches: &patches, seed: SEED };
        let tile = bake(&[skin], &square, [&self.hair[0], &self.hair[1]], &Self::recipe(), 3);
        (patches, tile)
    }

    fn judged(&self, patches: &Patches, tile: &Tile, groups: &[Vec<SurfacePoint>]) -> Vec<Vec<CoverageRow>> {
        let hair = [&self.hair[0], &self.hair[1]];
        surface_tables(&CoatedSkin { mesh: &self.mesh, fields: &self.fields, patches, tile, hair, seed: SEED }, groups)
    }

    /// Places well inside the quarter with these signs of x and y.
    fn quarter(&self, count: usize, signs: [f32; 2]) -> Vec<SurfacePoint> {
        let inside = |t: usize| self.mesh.corners_m(t).iter().all(|p| p.x * signs[0] > 8e-3 && p.y * signs[1] > 8e-3);
        places(&self.mesh, count, 5, inside)
    }
}

#[test]
fn every_region_of_an_atlas_covers_what_its_strands_cover() {
    let ball = Ball::new();
    let (patches, mut tile) = ball.baked(128);
    println!("texel {:.2} mm, {} charts", tile.edge_m / 128.0 * 1e3, patches.stats.patches);
    // Triangles at the borders between charts alone: hair is there once, whichever chart it grows in.
    let chart = |t: usize| patches.patch[patches.triangles[t][0] as usize];
    let topology = Topology::new(&ball.mesh.triangles, |v| ball.mesh.position_class[v as usize]);
    let at_border = |t: usize| (0..3).any(|k| topology.neighbour(t, k).is_some_and(|other| chart(other) != chart(t)));
    let quarter = |t: usize| ball.mesh.corners_m(t).iter().all(|p| p.x < -8e-3 && p.y < -8e-3);
    let groups = [
        ball.quarter(32, [-1.0, -1.0]),
        ball.quarter(32, [1.0, -1.0]),
        ball.quarter(32, [-1.0, 1.0]),
        ball.quarter(32, [1.0, 1.0]),
        places(&ball.mesh, 32, 5, |t| at_border(t) && quarter(t)),
    ];
    let names = ["full", "half density", "half length", "both", "borders"];
    for (name, rows) in names.iter().zip(ball.judged(&patches, &tile, &groups)) {
        print(name, &rows);
        assert_eq!(fault(&rows), None, "{name}");
    }
    // Planted: density counted twice, as a tile's would be.
    tile.sampled = Sampled::Square;
    let rows = &ball.judged(&patches, &tile, &[ball.quarter(16, [1.0, -1.0])])[0];
    assert!(fault(rows).is_some(), "density counted twice passes");
    // Planted: charts that show the hair of another place.
    tile.sampled = Sampled::Skin;
    let mut turned = patches.clone();
    turned.uv.iter_mut().for_each(|uv| *uv = Vec2::ONE - *uv);
    let rows = &ball.judged(&turned, &tile, &[ball.quarter(16, [1.0, 1.0])])[0];
    assert!(fault(rows).is_some(), "hair of another place passes");
}

#[test]
fn an_atlas_has_the_colours_of_its_places_and_the_same_bytes_for_any_number_of_threads() {
    let ball = Ball::new();
    let (patches, tile) = ball.baked(64);
    for t in (0..ball.mesh.triangles.len()).step_by(5) {
        let [p, q, r] = ball.mesh.corners_m(t);
        let z = (p.z + q.z + r.z) / 3.0;
        if z.abs() < 8e-3 {
            continue;
        }
        let [a, b, c] = patches.triangles[t].map(|v| patches.uv[v as usize]);
        let at = ((a + b + c) / 3.0 * 64.0).as_uvec2();
        let texel = tile.shells.albedo[0][2].pixel(at.x, at.y);
        assert!((texel[0] > texel[1]) == (z > 0.0), "triangle {t} at z = {z}: {texel:?}");
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert!(pool.install(|| ball.baked(64)).1 == tile);
}

#[test]
fn charts_that_do_not_fit_are_refused() {
    let ball = Ball::new();
    let method = Parameterisation::Atlas { texels_per_tile: 64, padding_texels: 4 };
    let mut patches = [parameterise(&ball.mesh, &ball.fields.direction, 8e-3, method).unwrap()];
    let error = fit_atlas(&mut patches, 8e-3, 4, 4).unwrap_err();
    assert!(error.to_string().contains("do not fit") && error.hint.is_some());
}

/// Mean optical depth of a fin texture in four bands, from the tips to the roots.
fn fin_depths(tile: &Tile) -> [f32; 4] {
    let image = &tile.fin.albedo[0];
    let rows = image.height as usize / 4;
    let depth = |i: usize| -(1.0 - f32::from(image.pixels[4 * i + 3]).min(254.0) / 255.0).ln();
    let band = |b: usize| rows * image.width as usize * b..rows * image.width as usize * (b + 1);
    [0, 1, 2, 3].map(|b| band(b).map(depth).sum::<f32>() / band(b).len() as f32)
}

#[test]
fn fins_show_hair_of_the_skin_with_length_and_density_taken_out() {
    let ball = Ball::new();
    let (_, tile) = ball.baked(64);
    let fibres = [&ball.hair[0], &ball.hair[1]];
    let flat = TileHair::grow(fibres[0], fibres[1], 8e-3, SEED);
    let flat = fin_depths(&furrier::coat::tile::bake(&flat, &Ball::recipe()));
    let grown = fin_depths(&tile);
    println!("tips to roots: {grown:.3?}, on a square {flat:.3?}");
    // The lower half, where every hair is; tips are few and vary from place to place.
    let off = |a: [f32; 4]| (2..4).map(|b| (a[b] / flat[b] - 1.0).abs()).fold(0.0, f32::max);
    assert!(off(grown) < 0.2, "{grown:?} on the skin, {flat:?} on a square");
    // Hair half as dense everywhere, or half as long: the coat's vertices say so, not the texture.
    let mut thinner = Ball::new();
    thinner.fields.density.iter_mut().for_each(|d| *d *= 0.5);
    thinner.fields.length.iter_mut().for_each(|l| *l *= 0.5);
    let thinned = fin_depths(&thinner.baked(64).1);
    println!("half of both: {thinned:.3?}");
    assert!(off(thinned) < 0.2, "{thinned:?} on the skin, {flat:?} on a square");
    // Planted: a preset of half the density, which belongs into the texture.
    thinner.hair.iter_mut().for_each(|fibre| fibre.density_per_m2 *= 0.5);
    assert!(off(fin_depths(&thinner.baked(64).1)) > 0.3, "half the hair passes");
}
