//! A colour for each level of detail.

use super::Seen;
use crate::error::Result;
use crate::math::Vec3;
use crate::runtime::gpu::Prepared;
use crate::runtime::{CoatMesh, DrawList, Frame, Picture, Show, SkinMesh};
use crate::viewer::chart::{self, Chart};

/// Colours of the levels, the finest first, linear RGB; coarser ones than these have the last.
const COLOURS: [(&str, Vec3); 5] = [
    ("red", Vec3::new(0.72, 0.10, 0.08)),
    ("yellow", Vec3::new(0.78, 0.58, 0.08)),
    ("green", Vec3::new(0.12, 0.45, 0.16)),
    ("blue", Vec3::new(0.10, 0.30, 0.70)),
    ("purple", Vec3::new(0.45, 0.15, 0.60)),
];
/// Skin without hair.
const BARE: Vec3 = Vec3::splat(0.3);

/// See [`super::draw`].
pub(super) fn draw(prepared: &Prepared<'_>, seen: &Seen<'_>) -> Result<(Picture, Vec<String>)> {
    let Seen { renderer, scene, frame, .. } = seen;
    let levels: Vec<(f32, f32)> =
        prepared.levels(frame).into_iter().map(|(detail, height_px)| (detail.level(), height_px)).collect();
    let bare = scene.skins.iter().filter(|skin| skin.tile.is_none()).map(|skin| SkinMesh {
        positions_m: skin.positions_m.clone(),
        normals: skin.normals.clone(),
        colour: vec![BARE; skin.positions_m.len()],
        triangles: skin.triangles.clone(),
        ..SkinMesh::default()
    });
    // In a passage between two tiles both lie on one skin.
    let alone = |(fur, _): &(&CoatMesh<'_>, &(f32, f32))| !fur.over_last;
    let furred = scene.furs.iter().zip(&levels).filter(alone).map(|(fur, (level, _))| SkinMesh {
        positions_m: fur.positions_m.clone(),
        normals: fur.normals.clone(),
        colour: vec![colour(*level); fur.positions_m.len()],
        triangles: fur.triangles.to_vec(),
        ..SkinMesh::default()
    });
    let coloured = DrawList { skins: bare.chain(furred).collect(), furs: Vec::new(), tiles: scene.tiles };
    let lit = chart::lit(Chart::Patches, frame.clip_from_world.row(3).truncate().normalize_or(Vec3::NEG_Z));
    let frame = Frame { lights: lit.lights, ambient: lit.ambient, shadow_map: false, ..(*frame).clone() };
    let skin = Show { shells: false, fins: false, ..Show::default() };
    let picture = renderer.prepare(&coloured)?.draw(&frame, skin)?.picture;

    let count = 1 + scene.tiles.iter().map(|tile| tile.levels.len()).max().unwrap_or(0);
    let named = (0..count).map(|level| format!("{level} {}", COLOURS[level.min(COLOURS.len() - 1)].0));
    let named: Vec<String> = named.collect();
    let mut legend = vec![format!("levels of detail, the finest first: {}", named.join(", "))];
    for (fur, (level, height_px)) in scene.furs.iter().zip(&levels) {
        let preset = &scene.tiles[fur.tile].preset;
        let line = format!("{preset}: level {level:.2}, its longest hair {height_px:.1} pixels high");
        if !legend.contains(&line) {
            legend.push(line);
        }
    }
    Ok((picture, legend))
}

/// Between those of two levels where one gives way to the other.
fn colour(level: f32) -> Vec3 {
    let at = level.clamp(0.0, (COLOURS.len() - 1) as f32);
    let below = (at as usize).min(COLOURS.len() - 2);
    COLOURS[below].1.lerp(COLOURS[below + 1].1, at - below as f32)
}
