//! Joints and the walk.

use crate::asset::document::Document;
use crate::asset::encode::Use;
use crate::math::{Quat, Vec3};
use serde_json::{Value, json};
use std::f32::consts::TAU;

/// A joint: where it turns, m, and what it hangs on.
pub struct Joint {
    name: &'static str,
    parent: Option<usize>,
    /// The same joint on the other side.
    pub mirror: usize,
    /// Where it turns.
    pub at: [f32; 3],
}

/// The root.
pub const HIPS: usize = 0;
/// Middle of the trunk.
pub const CHEST: usize = 1;
/// Between the shoulders.
pub const NECK: usize = 2;
/// Base of the skull.
pub const HEAD: usize = 3;
/// The right one follows.
pub const EAR_LEFT: usize = 4;
/// First of three.
pub const TAIL: usize = 6;
/// Upper and lower, then those of the right.
pub const FRONT_LEFT: usize = 9;
/// Upper and lower, then those of the right.
pub const HIND_LEFT: usize = 13;

const fn joint(name: &'static str, parent: Option<usize>, mirror: usize, at: [f32; 3]) -> Joint {
    Joint { name, parent, mirror, at }
}

/// All joints; parents come first, a lower leg behind its upper.
pub const JOINTS: [Joint; 17] = [
    joint("hips", None, 0, [0.0, 0.205, -0.12]),
    joint("chest", Some(HIPS), 1, [0.0, 0.205, -0.02]),
    joint("neck", Some(CHEST), 2, [0.0, 0.235, 0.11]),
    joint("head", Some(NECK), 3, [0.0, 0.325, 0.185]),
    joint("ear.left", Some(HEAD), 5, [0.037, 0.385, 0.2]),
    joint("ear.right", Some(HEAD), 4, [-0.037, 0.385, 0.2]),
    joint("tail.1", Some(HIPS), 6, [0.0, 0.222, -0.17]),
    joint("tail.2", Some(TAIL), 7, [0.0, 0.212, -0.245]),
    joint("tail.3", Some(7), 8, [0.0, 0.186, -0.325]),
    joint("front.left.upper", Some(CHEST), 11, [0.04, 0.195, 0.098]),
    joint("front.left.lower", Some(9), 12, [0.046, 0.112, 0.084]),
    joint("front.right.upper", Some(CHEST), 9, [-0.04, 0.195, 0.098]),
    joint("front.right.lower", Some(11), 10, [-0.046, 0.112, 0.084]),
    joint("hind.left.upper", Some(HIPS), 15, [0.038, 0.195, -0.128]),
    joint("hind.left.lower", Some(13), 16, [0.048, 0.122, -0.098]),
    joint("hind.right.upper", Some(HIPS), 13, [-0.038, 0.195, -0.128]),
    joint("hind.right.lower", Some(15), 14, [-0.048, 0.122, -0.098]),
];

/// Adds joints, skin and walk; gives the root node and the skin.
pub fn push(document: &mut Document) -> (usize, usize) {
    let first = document.count("nodes");
    for (index, joint) in JOINTS.iter().enumerate() {
        let parent = joint.parent.map_or([0.0; 3], |p| JOINTS[p].at);
        let offset = (Vec3::from_array(joint.at) - Vec3::from_array(parent)).to_array();
        // Tenths of a millimetre keep the file readable.
        let offset = offset.map(|c| (f64::from(c) * 1e4).round() / 1e4);
        let children: Vec<usize> =
            (0..JOINTS.len()).filter(|&c| JOINTS[c].parent == Some(index)).map(|c| first + c).collect();
        let mut node = json!({"name": joint.name, "translation": offset});
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        document.push("nodes", node);
    }
    let inverse_binds: Vec<f32> = JOINTS
        .iter()
        .flat_map(|j| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -j.at[0], -j.at[1], -j.at[2], 1.0])
        .collect();
    let matrices = document.push_floats(&inverse_binds, 16, Use::Other);
    let joints: Vec<usize> = (first..first + JOINTS.len()).collect();
    let skin = document.push("skins", json!({"inverseBindMatrices": matrices, "joints": joints, "skeleton": first}));
    walk(document, first);
    (first, skin)
}

/// A walk of one second: each joint swings about an axis, some twice as fast, each with its own delay.
fn walk(document: &mut Document, first: usize) {
    // Joint, axis, middle (rad), swing (rad), turns per second, delay (turns).
    const SWINGS: [(usize, Vec3, f32, f32, f32, f32); 16] = [
        (FRONT_LEFT, Vec3::X, 0.0, 0.42, 1.0, 0.00),
        (FRONT_LEFT + 1, Vec3::X, 0.22, 0.25, 1.0, 0.22),
        (FRONT_LEFT + 2, Vec3::X, 0.0, 0.42, 1.0, 0.50),
        (FRONT_LEFT + 3, Vec3::X, 0.22, 0.25, 1.0, 0.72),
        (HIND_LEFT, Vec3::X, 0.0, 0.38, 1.0, 0.60),
        (HIND_LEFT + 1, Vec3::X, -0.05, 0.24, 1.0, 0.82),
        (HIND_LEFT + 2, Vec3::X, 0.0, 0.38, 1.0, 0.10),
        (HIND_LEFT + 3, Vec3::X, -0.05, 0.24, 1.0, 0.32),
        (HIPS, Vec3::Z, 0.0, 0.05, 1.0, 0.10),
        (CHEST, Vec3::Y, 0.0, 0.06, 1.0, 0.30),
        (NECK, Vec3::X, 0.0, 0.06, 2.0, 0.10),
        (HEAD, Vec3::X, 0.03, 0.07, 2.0, 0.55),
        (TAIL, Vec3::Y, 0.0, 0.22, 1.0, 0.00),
        (TAIL + 1, Vec3::Y, 0.0, 0.26, 1.0, 0.15),
        (TAIL + 2, Vec3::Y, 0.0, 0.30, 1.0, 0.30),
        (EAR_LEFT, Vec3::X, -0.05, 0.08, 2.0, 0.30),
    ];
    const KEYS: usize = 17;
    let seconds: Vec<f32> = (0..KEYS).map(|key| key as f32 / (KEYS - 1) as f32).collect();
    let times = document.push_times(&seconds);
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    let mut channel = |document: &mut Document, node: usize, path: &str, values: &[f32], width: usize| {
        let output = document.push_floats(values, width, Use::Other);
        channels.push(json!({"sampler": samplers.len(), "target": {"node": node, "path": path}}));
        samplers.push(json!({"input": times, "output": output, "interpolation": "LINEAR"}));
    };
    let wave = |rate: f32, delay: f32, s: f32| libm::sinf(TAU * (rate * s - delay));
    for (joint, axis, middle, swing, rate, delay) in SWINGS {
        let turns = |&s: &f32| Quat::from_axis_angle(axis, middle + swing * wave(rate, delay, s)).to_array();
        let values: Vec<f32> = seconds.iter().flat_map(turns).collect();
        channel(document, first + joint, "rotation", &values, 4);
    }
    let hips = JOINTS[HIPS].at;
    let bob: Vec<f32> = seconds.iter().flat_map(|&s| [hips[0], hips[1] + 0.005 * wave(2.0, 0.2, s), hips[2]]).collect();
    channel(document, first + HIPS, "translation", &bob, 3);
    let animation: Value = json!({"name": "walk", "samplers": samplers, "channels": channels});
    document.push("animations", animation);
}
