//! Animations, skins and morphs at a moment, in f64: where every vertex of a part is, and where its hair points.

use super::Asset;
use super::document::Document;
use super::json::At;
use super::part::{Part, world_normal};
use super::scene_graph::{Local, unit};
use crate::error::{Error, Result};
use crate::math::{DMat3, DMat4, DQuat, DVec3, Mat3, Vec3};

/// The state of all nodes at a moment.
#[derive(Clone, Debug)]
pub struct Pose {
    /// World matrix per node, file units.
    pub world: Vec<DMat4>,
    /// Morph weights per node; empty where its mesh has none.
    pub weights: Vec<Vec<f64>>,
}

/// A part at a moment. Arrays have one entry per stored vertex.
#[derive(Clone, Debug)]
pub struct Posed {
    /// Positions, m, relative to the `origin_m` of [`Part::mesh`].
    pub positions_m: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Takes a coat's offset (the primitive's own space and units) to the world, m: the turn that morphing gives the
    /// normal, then the skin or node.
    pub world_from_offset: Vec<Mat3>,
    /// Whether windings turn round (a negative scale).
    pub mirrored: bool,
}

impl Asset {
    /// The pose of the file without any animation, with its default morph weights.
    ///
    /// # Errors
    /// Names weights that are not numbers.
    pub fn rest_pose(&self) -> Result<Pose> {
        Ok(Pose {
            world: self.scene.world(&self.scene.local),
            weights: self.with_instances(default_weights(&self.document)?),
        })
    }

    /// The animation of this name, or of this number if no name fits.
    ///
    /// # Errors
    /// Lists the animations there are.
    pub fn animation(&self, name: &str) -> Result<usize> {
        let names = self.animation_names();
        if let Some(found) = names.iter().position(|n| n == name) {
            return Ok(found);
        }
        match name.parse::<usize>() {
            Ok(index) if index < names.len() => Ok(index),
            _ => Err(Error::usage("there is no such animation")
                .with_parameter("animation")
                .with_found(name)
                .with_expected(if names.is_empty() {
                    "none: the file has no animation".into()
                } else {
                    format!("one of: {}", names.join(", "))
                })),
        }
    }

    /// Names of the animations; a nameless one goes by its number.
    pub fn animation_names(&self) -> Vec<String> {
        let list = self.document.root().list("animations").unwrap_or_default();
        let name = |(i, at): (usize, &At<'_>)| {
            at.get("name").and_then(|n| n.value.as_str()).map_or(i.to_string(), str::to_owned)
        };
        list.iter().enumerate().map(name).collect()
    }

    /// Time of the last key of animation `index`, s; 0 where it has none.
    ///
    /// # Errors
    /// Names the sampler whose keys cannot be read.
    pub fn animation_seconds(&self, index: usize) -> Result<f64> {
        let mut last: f64 = 0.0;
        for sampler in self.document.root().entry("animations", index)?.list("samplers")? {
            let times = self.document.floats(sampler.need("input")?.size()?, 1)?;
            last = times.iter().map(|&t| f64::from(t)).filter(|t| t.is_finite()).fold(last, f64::max);
        }
        Ok(last)
    }

    /// The pose at `seconds` into animation `index`; before its first and after its last key it stands still.
    ///
    /// # Errors
    /// Names the channel whose keys cannot be used.
    pub fn pose(&self, index: usize, seconds: f64) -> Result<Pose> {
        let mut local = self.scene.local.clone();
        let mut weights = default_weights(&self.document)?;
        let animation = self.document.root().entry("animations", index)?;
        for channel in animation.list("channels")? {
            let target = channel.need("target")?;
            let Some(node) = target.reference("node", "nodes", self.scene.document_nodes)? else { continue };
            let sampler = animation.entry("samplers", channel.need("sampler")?.size()?)?;
            let path = target.need("path")?.text()?;
            let width = match path {
                "translation" | "scale" => 3,
                "rotation" => 4,
                "weights" => weights[node].len(),
                _ => continue,
            };
            let Some(value) = sample(&self.document, &sampler, width, seconds, path == "rotation")? else { continue };
            match (path, &mut local[node]) {
                ("weights", _) => weights[node] = value,
                ("translation", Local::Trs { translation, .. }) => *translation = DVec3::from_slice(&value),
                ("scale", Local::Trs { scale, .. }) => *scale = DVec3::from_slice(&value),
                ("rotation", Local::Trs { rotation, .. }) => {
                    *rotation = unit(DQuat::from_slice(&value)).unwrap_or(*rotation)
                }
                _ => return Err(target.fault("a node without a matrix, because it is animated")),
            }
        }
        Ok(Pose { world: self.scene.world(&local), weights: self.with_instances(weights) })
    }

    /// Weights of all nodes, given those of the document's: instances have their node's.
    fn with_instances(&self, mut weights: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let nodes = self.scene.document_nodes..self.scene.local.len();
        weights.extend(nodes.map(|node| weights[self.scene.of_document(node)].clone()).collect::<Vec<_>>());
        weights
    }
}

impl Part {
    /// The part in `pose`, as shown by `node` (one of [`Part::nodes`]).
    pub fn posed(&self, asset: &Asset, pose: &Pose, node: usize, metres_per_unit: f64) -> Posed {
        let stored = &self.stored;
        let weights = pose.weights.get(node).map_or(&[][..], Vec::as_slice);
        let skinned = self.skin_under(node).zip(stored.influences.as_ref());
        let joints = skinned.map(|(skin, _)| asset.scene.joint_matrices(skin, &pose.world));
        let mut posed =
            Posed { positions_m: Vec::new(), normals: Vec::new(), world_from_offset: Vec::new(), mirrored: false };
        let mut signs = 0.0;
        for v in 0..self.vertices() {
            let (mut point, mut normal) = (stored.positions[v].as_dvec3(), stored.normals[v].as_dvec3());
            for (morph, &weight) in stored.morphs.iter().zip(weights) {
                let change = |list: &[Vec3]| list.get(v).map_or(DVec3::ZERO, |d| d.as_dvec3() * weight);
                point += change(&morph.positions);
                normal += change(&morph.normals);
            }
            let rest = stored.normals[v].as_dvec3();
            let turn = normal.try_normalize().map_or(DMat3::IDENTITY, |n| turn(rest, n));
            let map = match (&joints, skinned) {
                (Some(joints), Some((_, influences))) => influences[v]
                    .iter()
                    .filter(|&&(_, weight)| weight > 0.0)
                    .fold(DMat4::ZERO, |sum, &(joint, weight)| sum + joints[usize::from(joint)] * f64::from(weight)),
                _ => pose.world[node],
            };
            let linear = DMat3::from_mat4(map);
            let world = map.transform_point3(point);
            signs += linear.determinant().signum();
            posed.positions_m.push(((world - self.centre_units) * metres_per_unit).as_vec3());
            posed.normals.push(world_normal(&linear, (turn * rest).as_vec3()));
            posed.world_from_offset.push((linear * turn * metres_per_unit).as_mat3());
        }
        posed.mirrored = signs < 0.0;
        posed
    }
}

/// The smallest rotation that takes the unit vector `from` to the unit vector `to`.
pub(super) fn turn(from: DVec3, to: DVec3) -> DMat3 {
    DMat3::from_quat(DQuat::from_rotation_arc(from.try_normalize().unwrap_or(DVec3::Y), to))
}

fn default_weights(document: &Document) -> Result<Vec<Vec<f64>>> {
    let root = document.root();
    let meshes = root.list("meshes")?;
    let read = |owner: &At<'_>| owner.list("weights")?.iter().map(At::number).collect::<Result<Vec<f64>>>();
    let mut all = Vec::new();
    for node in root.list("nodes")? {
        let Some(mesh) = node.reference("mesh", "meshes", meshes.len())? else {
            all.push(Vec::new());
            continue;
        };
        let primitives = meshes[mesh].list("primitives")?;
        let targets = primitives.first().map_or(Ok(0), |p| p.list("targets").map(|list| list.len()))?;
        let mut weights = if node.get("weights").is_some() { read(&node)? } else { read(&meshes[mesh])? };
        weights.resize(targets, 0.0);
        all.push(weights);
    }
    Ok(all)
}

/// The value of an animation sampler at `seconds` (glTF 2.0, appendix C); none where it has no keys.
fn sample(
    document: &Document,
    sampler: &At<'_>,
    width: usize,
    seconds: f64,
    rotation: bool,
) -> Result<Option<Vec<f64>>> {
    let times = document.floats(sampler.need("input")?.size()?, 1)?;
    let output_at = sampler.need("output")?;
    let layout = super::accessor::AccessorLayout::of(document, output_at.size()?)?;
    let values = layout.floats(document);
    let method = sampler.get("interpolation");
    let method = method.as_ref().map_or(Ok("LINEAR"), At::text)?;
    let cubic = method == "CUBICSPLINE";
    let step = width * if cubic { 3 } else { 1 };
    if times.is_empty() || width == 0 {
        return Ok(None);
    }
    if values.len() < times.len() * step || values.iter().chain(&times).any(|v| !v.is_finite()) {
        return Err(output_at.fault(&format!("{} finite numbers, {step} per key", times.len() * step)));
    }
    let value = |key: usize, part: usize| -> Vec<f64> {
        values[key * step + part * width..][..width].iter().map(|&v| f64::from(v)).collect()
    };
    let middle = usize::from(cubic);
    let after = times.partition_point(|&t| f64::from(t) <= seconds);
    if after == 0 || after == times.len() || method == "STEP" {
        return Ok(Some(value(after.saturating_sub(1), middle)));
    }
    let (start, end) = (f64::from(times[after - 1]), f64::from(times[after]));
    let (span, t) = (end - start, (seconds - start) / (end - start));
    let (a, b) = (value(after - 1, middle), value(after, middle));
    if cubic {
        let (out, into) = (value(after - 1, 2), value(after, 0));
        let (t2, t3) = (t * t, t * t * t);
        let hermite = |i: usize| {
            (2.0 * t3 - 3.0 * t2 + 1.0) * a[i]
                + span * (t3 - 2.0 * t2 + t) * out[i]
                + (3.0 * t2 - 2.0 * t3) * b[i]
                + span * (t3 - t2) * into[i]
        };
        return Ok(Some((0..width).map(hermite).collect()));
    }
    if rotation {
        let (Some(from), Some(to)) = (unit(DQuat::from_slice(&a)), unit(DQuat::from_slice(&b))) else {
            return Ok(Some(a));
        };
        return Ok(Some(from.slerp(to, t).to_array().to_vec()));
    }
    Ok(Some(a.iter().zip(&b).map(|(a, b)| a + (b - a) * t).collect()))
}
