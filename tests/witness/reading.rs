//! glTF as the crate `gltf` reads it, and poses by plain formulas (glTF 2.0, appendix C) over what it read.

use furrier::math::{DMat4, DQuat, DVec3, Vec3};
use gltf::animation::Interpolation;
use gltf::animation::util::ReadOutputs;
use gltf::scene::Transform;
use std::collections::BTreeMap;

/// A GLB as the crate reads it.
pub struct Reading {
    pub gltf: gltf::Gltf,
}

/// A primitive's triangles and what moves them; lists have one entry per vertex.
pub struct Primitive {
    pub positions: Vec<Vec3>,
    /// Those on three points; each begins with its lowest index.
    pub triangles: Vec<[u32; 3]>,
    /// Weight by joint, scaled to sum to 1; empty where there are none.
    pub weights: Vec<BTreeMap<u16, f32>>,
    /// Changes of positions and normals per target; a list is empty where the target has none.
    pub morphs: Vec<[Vec<Vec3>; 2]>,
}

/// World matrix and morph weights per node.
#[derive(Clone)]
pub struct Moment {
    pub world: Vec<DMat4>,
    pub weights: Vec<Vec<f64>>,
}

/// A triangle from its lowest index on, the way round kept.
pub fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

impl Reading {
    /// Panics where the crate refuses the file.
    pub fn of(bytes: &[u8]) -> Self {
        Self { gltf: gltf::Gltf::from_slice(bytes).expect("the gltf crate reads it") }
    }

    /// The bytes of a buffer of a GLB.
    pub fn bytes(&self, buffer: gltf::Buffer<'_>) -> Option<&[u8]> {
        assert!(matches!(buffer.source(), gltf::buffer::Source::Bin), "a buffer inside the GLB");
        self.gltf.blob.as_deref()
    }

    /// A primitive of triangles, strips or fans.
    pub fn primitive(&self, primitive: &gltf::Primitive<'_>) -> Primitive {
        let reader = primitive.reader(|buffer| self.bytes(buffer));
        let positions: Vec<Vec3> = reader.read_positions().expect("positions").map(Vec3::from).collect();
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        let triangles: Vec<[u32; 3]> = match primitive.mode() {
            gltf::mesh::Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            gltf::mesh::Mode::TriangleStrip => {
                (0..indices.len() - 2).map(|i| [i, i + 1 + i % 2, i + 2 - i % 2].map(|at| indices[at])).collect()
            }
            gltf::mesh::Mode::TriangleFan => {
                (0..indices.len() - 2).map(|i| [i + 1, i + 2, 0].map(|at| indices[at])).collect()
            }
            mode => panic!("{mode:?} has no triangles"),
        };
        // Strips are sewn together by triangles on two points.
        let distinct = |t: &[u32; 3]| (0..3).all(|i| positions[t[i] as usize] != positions[t[(i + 1) % 3] as usize]);
        let triangles = triangles.into_iter().filter(distinct).map(turned).collect();
        let mut weights = Vec::new();
        for set in 0.. {
            let (Some(joints), Some(shares)) = (reader.read_joints(set), reader.read_weights(set)) else { break };
            weights.resize(positions.len(), BTreeMap::new());
            for ((all, joints), shares) in weights.iter_mut().zip(joints.into_u16()).zip(shares.into_f32()) {
                joints.iter().zip(shares).for_each(|(&joint, share)| *all.entry(joint).or_insert(0.0) += share);
            }
        }
        for all in &mut weights {
            all.retain(|_, share| *share > 0.0);
            let sum: f32 = all.values().sum();
            all.values_mut().for_each(|share| *share /= sum);
        }
        let changes = |list: Option<gltf::accessor::Iter<'_, [f32; 3]>>| -> Vec<Vec3> {
            list.map_or(Vec::new(), |list| list.map(Vec3::from).collect())
        };
        let morphs = reader.read_morph_targets().map(|(p, n, _)| [changes(p), changes(n)]).collect();
        Primitive { positions, triangles, weights, morphs }
    }

    /// Nodes of the default scene that show mesh `mesh`.
    pub fn shown(&self, mesh: usize) -> Vec<usize> {
        let mut reached: Vec<_> =
            self.gltf.default_scene().or(self.gltf.scenes().next()).expect("a scene").nodes().collect();
        let mut found = Vec::new();
        while let Some(node) = reached.pop() {
            found.extend(node.mesh().filter(|m| m.index() == mesh).map(|_| node.index()));
            reached.extend(node.children());
        }
        found.sort_unstable();
        found
    }

    /// Time of an animation's last key, s.
    pub fn duration_s(&self, index: usize) -> f64 {
        let animation = self.gltf.animations().nth(index).expect("an animation");
        let keys = |channel: gltf::animation::Channel<'_>| {
            let reader = channel.reader(|_| self.gltf.blob.as_deref());
            reader.read_inputs().expect("keys").map(f64::from).fold(0.0, f64::max)
        };
        animation.channels().map(keys).fold(0.0, f64::max)
    }

    /// All nodes at `seconds` of an animation, or at rest.
    pub fn moment(&self, at: Option<(usize, f64)>) -> Moment {
        let mut local: Vec<(DVec3, DQuat, DVec3)> = Vec::new();
        let mut weights = Vec::new();
        for node in self.gltf.nodes() {
            let (t, r, s) = node.transform().decomposed();
            local.push((Vec3::from(t).as_dvec3(), quaternion(&r.map(f64::from)), Vec3::from(s).as_dvec3()));
            let stated = node.weights().or(node.mesh().and_then(|mesh| mesh.weights())).unwrap_or_default();
            let targets =
                node.mesh().map_or(0, |mesh| mesh.primitives().map(|p| p.morph_targets().count()).max().unwrap_or(0));
            let mut own: Vec<f64> = stated.iter().map(|&w| f64::from(w)).collect();
            own.resize(targets, 0.0);
            weights.push(own);
        }
        let mut moved = vec![false; local.len()];
        if let Some((animation, seconds)) = at {
            for channel in self.gltf.animations().nth(animation).expect("an animation").channels() {
                let node = channel.target().node().index();
                moved[node] = true;
                let reader = channel.reader(|buffer| self.bytes(buffer));
                let times: Vec<f64> = reader.read_inputs().expect("times").map(f64::from).collect();
                let three =
                    |list: gltf::accessor::Iter<'_, [f32; 3]>| list.flatten().map(f64::from).collect::<Vec<_>>();
                let sample = |values: &[f64], width, turns| {
                    interpolated(&times, values, width, channel.sampler().interpolation(), seconds, turns)
                };
                match reader.read_outputs().expect("values") {
                    ReadOutputs::Translations(list) => {
                        local[node].0 = DVec3::from_slice(&sample(&three(list), 3, false))
                    }
                    ReadOutputs::Scales(list) => local[node].2 = DVec3::from_slice(&sample(&three(list), 3, false)),
                    ReadOutputs::Rotations(list) => {
                        let values: Vec<f64> = list.into_f32().flatten().map(f64::from).collect();
                        local[node].1 = quaternion(&sample(&values, 4, true));
                    }
                    ReadOutputs::MorphTargetWeights(list) => {
                        let values: Vec<f64> = list.into_f32().map(f64::from).collect();
                        weights[node] = sample(&values, weights[node].len(), false);
                    }
                }
            }
        }
        let mut world = vec![None; local.len()];
        let children: Vec<usize> = self.gltf.nodes().flat_map(|node| node.children()).map(|c| c.index()).collect();
        let mut open: Vec<_> =
            self.gltf.nodes().filter(|n| !children.contains(&n.index())).map(|n| (n, DMat4::IDENTITY)).collect();
        while let Some((node, above)) = open.pop() {
            let (translation, rotation, scale) = local[node.index()];
            let own = match node.transform() {
                Transform::Matrix { matrix } if !moved[node.index()] => {
                    DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from)))
                }
                _ => DMat4::from_translation(translation) * DMat4::from_quat(rotation) * DMat4::from_scale(scale),
            };
            world[node.index()] = Some(above * own);
            open.extend(node.children().map(|child| (child, above * own)));
        }
        Moment { world: world.into_iter().map(|w| w.expect("no node is its own parent")).collect(), weights }
    }

    /// Where `node` shows the primitive's vertices: morphed, then skinned or placed, file units.
    pub fn places(&self, primitive: &Primitive, node: usize, moment: &Moment) -> Vec<DVec3> {
        let at = self.gltf.nodes().nth(node).expect("a node");
        let joints: Option<Vec<DMat4>> = at.skin().map(|skin| {
            let reader = skin.reader(|buffer| self.bytes(buffer));
            let bind = |m: [[f32; 4]; 4]| DMat4::from_cols_array_2d(&m.map(|column| column.map(f64::from)));
            let binds: Vec<DMat4> = match reader.read_inverse_bind_matrices() {
                Some(list) => list.map(bind).collect(),
                None => vec![DMat4::IDENTITY; skin.joints().count()],
            };
            skin.joints().zip(binds).map(|(joint, bind)| moment.world[joint.index()] * bind).collect()
        });
        let place = |v: usize| {
            let mut point = primitive.positions[v].as_dvec3();
            for ([positions, _], weight) in primitive.morphs.iter().zip(&moment.weights[node]) {
                point += positions.get(v).map_or(DVec3::ZERO, |change| change.as_dvec3() * *weight);
            }
            match joints.as_ref().filter(|_| !primitive.weights.is_empty()) {
                Some(joints) => primitive.weights[v]
                    .iter()
                    .map(|(&joint, &share)| joints[usize::from(joint)].transform_point3(point) * f64::from(share))
                    .sum(),
                None => moment.world[node].transform_point3(point),
            }
        };
        (0..primitive.positions.len()).map(place).collect()
    }
}

fn quaternion(of: &[f64]) -> DQuat {
    DQuat::from_slice(of).normalize()
}

/// The value of a sampler at `seconds`.
fn interpolated(times: &[f64], values: &[f64], width: usize, by: Interpolation, seconds: f64, turns: bool) -> Vec<f64> {
    let cubic = by == Interpolation::CubicSpline;
    // Of a spline's key: slope in, value, slope out.
    let key = |k: usize, part: usize| {
        let first = if cubic { (3 * k + part) * width } else { k * width };
        &values[first..first + width]
    };
    let next = times.iter().take_while(|&&t| t <= seconds).count();
    if next == 0 || next == times.len() || by == Interpolation::Step {
        return key(next.max(1) - 1, 1).to_vec();
    }
    let (a, b) = (key(next - 1, 1), key(next, 1));
    let length = times[next] - times[next - 1];
    let t = (seconds - times[next - 1]) / length;
    let mix = |of_a: f64, of_b: f64| a.iter().zip(b).map(|(a, b)| a * of_a + b * of_b).collect::<Vec<_>>();
    if cubic {
        let slopes = key(next - 1, 2)
            .iter()
            .zip(key(next, 0))
            .map(|(out, into)| length * (out * (t - 2.0 * t.powi(2) + t.powi(3)) + into * (t.powi(3) - t.powi(2))));
        let values = mix(1.0 - 3.0 * t.powi(2) + 2.0 * t.powi(3), 3.0 * t.powi(2) - 2.0 * t.powi(3));
        return values.iter().zip(slopes).map(|(value, slope)| value + slope).collect();
    }
    if !turns {
        return mix(1.0 - t, t);
    }
    let cosine: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let angle = cosine.abs().min(1.0).acos();
    if angle < 1e-6 {
        return mix(1.0 - t, t * cosine.signum());
    }
    mix(((1.0 - t) * angle).sin() / angle.sin(), cosine.signum() * (t * angle).sin() / angle.sin())
}
