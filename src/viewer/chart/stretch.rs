//! How far the texture is stretched or squeezed, triangle by triangle.

use super::CoveredPart;
use super::colours::{BEYOND, diverging};
use crate::data::coat::Coat;
use crate::error::Result;
use crate::fur::patch;
use crate::math::Vec3;
use crate::runtime::SkinMesh;

/// Singular values that the map's ends stand for.
const ENDS: [f64; 2] = [0.7, 1.4];

/// See [`super::draw`].
pub(super) fn draw<'a>(all: &[CoveredPart<'_>], coat: &Coat) -> Result<(Vec<SkinMesh<'a>>, Vec<String>)> {
    let mut skins = Vec::with_capacity(all.len());
    let mut values = Vec::new();
    for covered in all {
        let of_triangle = farthest(covered, coat)?;
        values.extend(of_triangle.iter().flatten().copied());
        skins.push(covered.facets(|t| of_triangle[t].map_or(BEYOND, |(value, _)| colour(value))));
    }
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let area: f64 = values.iter().map(|v| v.1).sum();
    let share = |wanted: &dyn Fn(f64) -> bool| {
        100.0 * values.iter().filter(|v| wanted(v.0)).map(|v| v.1).sum::<f64>() / area.max(f64::MIN_POSITIVE)
    };
    let legend = vec![
        format!(
            "colour is how much texture lies along a length of skin, in the direction in which that is farthest from 1: white \
             1, as on the flat tile; blue less (hair drawn out), deepest at {}; red more (hair squeezed), deepest at {}; \
             yellow beyond these",
            ENDS[0], ENDS[1]
        ),
        format!(
            "least {:.3}, most {:.3}; {:.1} % of the skin is within 0.9 to 1.1, {:.1} % within 0.7 to 1.4",
            values.first().map_or(1.0, |v| v.0),
            values.last().map_or(1.0, |v| v.0),
            share(&|v| (0.9..=1.1).contains(&v)),
            share(&|v| (ENDS[0]..=ENDS[1]).contains(&v)),
        ),
    ];
    Ok((skins, legend))
}

/// Per coat triangle: the singular value farthest from 1, and the triangle's area; `None` without area.
fn farthest(covered: &CoveredPart<'_>, coat: &Coat) -> Result<Vec<Option<(f64, f64)>>> {
    let (mesh, patches) = covered.laid(coat)?;
    let edge_m = f64::from(coat.tiles[covered.primitive.tile].edge_m);
    let values = patch::singular_values(&mesh, edge_m, &patches);
    let pick = |(t, values): (usize, Option<[f64; 2]>)| {
        let [large, small] = values?;
        let value = if large * small > 1.0 { large } else { small };
        Some((value, f64::from(mesh.area_m2(t))))
    };
    Ok(values.into_iter().enumerate().map(pick).collect())
}

fn colour(value: f64) -> Vec3 {
    if !(ENDS[0]..=ENDS[1]).contains(&value) {
        return BEYOND;
    }
    let t = libm::log(value);
    diverging((if t < 0.0 { -t / libm::log(ENDS[0]) } else { t / libm::log(ENDS[1]) }) as f32)
}
