//! A coat made longer or laid down as a whole, after it was baked (Lengyel et al. 2001 §3). In: the offsets of a posed coat. Out: the same,
//! stretched and turned. What is baked into the slabs stays as it is.

use crate::data::mesh::{Mesh, position_classes};
use crate::error::{Error, Result};
use crate::fur::groom::lean::Standing;
use crate::fur::groom::unfold::unfold;
use crate::math::Vec3;
use crate::runtime::{CoatMesh, DrawList};

/// Factors on length that there are.
pub const LENGTHS: [f32; 2] = [0.1, 4.0];
/// Slants that there are, degrees.
pub const SLANTS_DEG: [f32; 2] = [-75.0, 75.0];
/// Hair lies down to this angle from the normal at most, degrees: as far as that of a bake does.
const FLATTEST_DEG: f32 = 80.0;
/// Share of the stack's height up to which hair must not cross: there it is dense. As in a bake, single guard hairs above may.
const DENSE: f32 = 0.5;
/// Share of its length along the skin from which on hair leans somewhere.
const LEANS: f32 = 0.02;
/// Texels from slab to slab beyond which a coat is seen to fall apart into its layers (`docs/steps/runtime.md`).
pub const OUT_OF_LINE: f32 = 20.0;

/// How a whole coat is combed anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combing {
    /// Factor on the length of all hair.
    pub length: f32,
    /// By how much it leans more the way it leans already, degrees; less where it is negative. Hair that stands upright leans downwards.
    pub slant_deg: f32,
}

impl Default for Combing {
    fn default() -> Self {
        Self { length: 1.0, slant_deg: 0.0 }
    }
}

impl Combing {
    /// With a factor on length from 0.1 to 4, and a slant from -75 to 75 degrees.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for one that is out of range or no number.
    pub fn new(length: f32, slant_deg: f32) -> Result<Self> {
        let within = |parameter: &'static str, value: f32, [low, high]: [f32; 2]| match (low..=high).contains(&value) {
            true => Ok(value),
            false => Err(Error::usage("the coat cannot be combed so")
                .with_parameter(parameter)
                .with_found(value)
                .with_expected(format!("{low} to {high}"))),
        };
        Ok(Self { length: within("lengthen", length, LENGTHS)?, slant_deg: within("slant", slant_deg, SLANTS_DEG)? })
    }

    /// Combs the coats of `scene`. Without a change they stay the bits that they are.
    pub fn comb(&self, scene: &mut DrawList<'_>) {
        if *self == Self::default() {
            return;
        }
        let (mut before_m, mut after_m) = (0.0_f64, 0.0_f64);
        for fur in &mut scene.furs {
            let heights_m = |fur: &CoatMesh<'_>| -> f64 {
                fur.offsets_m.iter().zip(&fur.normals).map(|(o, n)| f64::from(o.dot(*n))).sum()
            };
            before_m += heights_m(fur);
            for (offset_m, &normal) in fur.offsets_m.iter_mut().zip(&fur.normals) {
                *offset_m = self.combed(*offset_m, normal);
            }
            give_way(fur);
            after_m += heights_m(fur);
        }
        // Skin is shaded by how high hair stands over it; it has vertices of its own.
        let rise = if before_m > 0.0 { (after_m / before_m) as f32 } else { 1.0 };
        scene.skins.iter_mut().flat_map(|skin| &mut skin.hair_m).for_each(|hair_m| *hair_m *= rise);
    }

    fn combed(&self, offset_m: Vec3, normal: Vec3) -> Vec3 {
        let length_m = offset_m.length();
        let up_m = offset_m.dot(normal);
        let along = offset_m - normal * up_m;
        // Hair that leans nowhere, or under its skin, is told by gravity.
        let down = || Vec3::NEG_Y - normal * Vec3::NEG_Y.dot(normal);
        let leans = along.length() > LEANS * length_m;
        let Some(towards) = (if leans { along } else { down() }).try_normalize() else { return offset_m * self.length };
        let lean_rad = libm::atan2f(offset_m.dot(towards), up_m);
        let most_rad = FLATTEST_DEG.to_radians().max(lean_rad);
        let lean_rad = (lean_rad + self.slant_deg.to_radians()).clamp(-FLATTEST_DEG.to_radians(), most_rad);
        let (sin, cos) = libm::sincosf(lean_rad);
        (normal * cos + towards * sin) * (length_m * self.length)
    }
}

/// Combs hair apart that would now run into its neighbours in creases, or under the skin beside it, as a bake does.
fn give_way(fur: &mut CoatMesh<'_>) {
    let mesh = Mesh {
        positions_m: fur.positions_m.clone(),
        normals: fur.normals.clone(),
        triangles: fur.triangles.to_vec(),
        position_class: position_classes(&fur.positions_m, 0.0),
        ..Mesh::default()
    };
    let standing = Standing::new(&mesh);
    let raised = |(v, offset_m): (usize, &Vec3)| {
        standing.raised(v, mesh.position_class[v] as usize, offset_m.try_normalize().unwrap_or(fur.normals[v]))
    };
    let mut lean: Vec<Vec3> = fur.offsets_m.iter().enumerate().map(raised).collect();
    let mut length_m: Vec<f32> = fur.offsets_m.iter().map(|offset_m| offset_m.length()).collect();
    unfold(&mesh, &standing, DENSE, &mut lean, &mut length_m);
    for (offset_m, (lean, length_m)) in fur.offsets_m.iter_mut().zip(lean.into_iter().zip(length_m)) {
        *offset_m = lean * length_m;
    }
}

/// How far hair goes along the skin from one slab to the next, in widths of a texel, of the coat that goes furthest in the mean: beyond
/// [`OUT_OF_LINE`] slabs no longer line up.
pub fn step_texels(scene: &DrawList<'_>) -> f32 {
    let of = |fur: &CoatMesh<'_>| {
        let Some(tile) = scene.tiles.get(fur.tile) else { return 0.0 };
        let furred = || fur.offsets_m.iter().zip(&fur.normals).filter(|(offset_m, _)| **offset_m != Vec3::ZERO);
        let along_m: f32 =
            furred().map(|(offset_m, normal)| (*offset_m - *normal * offset_m.dot(*normal)).length()).sum();
        let mean_m = along_m / furred().count().max(1) as f32;
        mean_m / tile.shells.layers.max(1) as f32 * tile.shells.size as f32 / tile.edge_m
    };
    scene.furs.iter().map(of).fold(0.0, f32::max)
}
