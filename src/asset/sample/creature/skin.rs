//! What grows where: colour, length and direction of the creature's fur.

use super::skeleton::{EAR_LEFT, FRONT_LEFT, HEAD, HIND_LEFT, JOINTS, NECK, TAIL};
use super::smoothstep;
use crate::math::{Vec3, Vec4};

const NOSE: Vec3 = Vec3::new(0.0, 0.326, 0.335);
const RUST: Vec3 = Vec3::new(0.52, 0.17, 0.036);
const CREAM: Vec3 = Vec3::new(0.82, 0.72, 0.58);
const SOOT: Vec3 = Vec3::new(0.035, 0.024, 0.02);

/// What holds a point of the skin.
pub type Hold = ([u8; 4], Vec4);

/// The share that joints `first` to `first + count` have in a point.
fn share((joints, weights): &Hold, first: usize, count: usize) -> f32 {
    let of = |i: usize| (first..first + count).contains(&usize::from(joints[i]));
    (0..4).filter(|&i| of(i)).map(|i| weights[i]).sum()
}

/// Linear RGB at a point of the skin.
pub fn colour(hold: &Hold, point: Vec3, normal: Vec3) -> Vec3 {
    let ears = share(hold, EAR_LEFT, 2);
    let legs = share(hold, FRONT_LEFT, JOINTS.len() - FRONT_LEFT);
    let tail = share(hold, TAIL, 3);
    let head = share(hold, HEAD, 1);
    let neck = share(hold, NECK, 1);
    let trunk = (1.0 - ears - legs - tail - head - neck).max(0.0);
    // Below: belly, throat and breast; on the head, cheeks and chin.
    let below = smoothstep(0.15, 0.75, -normal.y);
    let breast = smoothstep(0.05, 0.55, normal.z - 0.35 * normal.y) * smoothstep(0.06, 0.11, point.z);
    let cheeks = smoothstep(0.345, 0.325, point.y) * smoothstep(0.21, 0.25, point.z);
    let chin = smoothstep(0.0, 0.5, -normal.y);
    let tip = smoothstep(-0.375, -0.405, point.z);
    let cream = (trunk * below.max(breast * smoothstep(0.26, 0.22, point.y)))
        .max(neck * below.max(breast))
        .max(head * cheeks.max(chin))
        .max(tail * tip)
        .min(1.0);
    let socks = legs * smoothstep(0.115, 0.06, point.y);
    let ear_tips = ears * smoothstep(0.425, 0.455, point.y);
    let inner_ears = ears * smoothstep(0.2, 0.6, normal.z) * smoothstep(0.465, 0.44, point.y);
    RUST.lerp(CREAM, cream).lerp(SOOT, socks.max(ear_tips).min(1.0)).lerp(CREAM * 0.8, 0.8 * inner_ears)
}

/// Hair length over the preset's.
pub fn length(hold: &Hold, point: Vec3) -> f32 {
    let ears = share(hold, EAR_LEFT, 2);
    let tail = share(hold, TAIL, 3) * smoothstep(-0.19, -0.26, point.z);
    let head = share(hold, HEAD, 1);
    let legs = share(hold, FRONT_LEFT, 4) + share(hold, HIND_LEFT, 4);
    let lower = legs * smoothstep(0.17, 0.08, point.y);
    let breast = share(hold, NECK, 1) * smoothstep(0.12, 0.16, point.z);
    // The face shortens towards the nose.
    let face = head * smoothstep(0.14, 0.02, point.distance(NOSE));
    let length = 1.0 + 0.9 * tail + 0.25 * breast - 0.45 * head - 0.32 * face - 0.55 * ears - 0.62 * lower;
    let eye = Vec3::new(0.0345_f32.copysign(point.x), 0.356, 0.2745);
    let clear = smoothstep(0.012, 0.030, point.distance(eye)) * smoothstep(0.008, 0.022, point.distance(NOSE));
    length.max(0.12) * (0.15 + 0.85 * clear)
}

/// Where the hair is combed: from the nose back, along the trunk to the tail, down the legs, out along ears and tail.
pub fn direction((joints, weights): &Hold, point: Vec3) -> Vec3 {
    let side = point.x.signum();
    let of = |joint: usize| match joint {
        HEAD => (point - NOSE).normalize_or_zero(),
        j if j == EAR_LEFT || j == EAR_LEFT + 1 => Vec3::new(0.35 * side, 1.0, -0.1),
        NECK => Vec3::new(0.0, -0.75, -0.65),
        j if (TAIL..TAIL + 3).contains(&j) => Vec3::new(0.0, -0.15, -1.0),
        j if j >= FRONT_LEFT => Vec3::new(0.0, -1.0, -0.25),
        _ => Vec3::new(0.15 * side, -0.4, -1.0),
    };
    (0..4).map(|i| of(usize::from(joints[i])).normalize_or_zero() * weights[i]).sum::<Vec3>().normalize_or_zero()
}
