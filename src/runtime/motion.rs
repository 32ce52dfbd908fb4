//! Hair that moves: wind, and the lag behind a skin that moves (`docs/steps/motion.md`). In: the offsets of a posed coat. Out: the
//! same, turned: no hair changes its length.

use super::draw_list::{CoatMesh, DrawList};
use crate::math::Vec3;

/// Furthest that a tip may be from where it rests, in lengths of its hair: 56°.
const FURTHEST: f32 = 1.5;
/// A tip that is nearer to where it rests, in lengths of its hair, and as slow, has come to rest.
const STILL: f32 = 1e-5;
/// Speed of a wind that bends hair by as much as it is long, m/s.
const BENDING_M_PER_S: f32 = 14.0;
/// Frequencies and wave numbers of gusts, over those of the first, and their shares: no whole ratios, so that they do not repeat.
const GUSTS: [(f32, f32); 3] = [(1.0, 0.5), (2.3, 0.3), (5.1, 0.2)];

/// A wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// Where it blows to, of any length.
    pub towards: Vec3,
    /// m/s; 0 for none.
    pub speed_m_per_s: f32,
    /// How far it swells and falls, 0 to 1 of its speed.
    pub gusts: f32,
    /// Length of a gust along the wind, m.
    pub gust_m: f32,
}

impl Default for Wind {
    fn default() -> Self {
        Self { towards: Vec3::X, speed_m_per_s: 0.0, gusts: 0.4, gust_m: 1.5 }
    }
}

/// How hair swings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Swings in a second, without damping.
    pub frequency_hz: f32,
    /// Share of the damping at which nothing swings, 0 to 1.
    pub damping: f32,
}

impl Default for Spring {
    fn default() -> Self {
        Self { frequency_hz: 3.0, damping: 0.35 }
    }
}

/// How far tips are from where they rest, m, and how quickly that changes, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tip {
    away_m: Vec3,
    speed: Vec3,
    /// Where it rested at the last step, and how quickly it went there.
    rest_m: Vec3,
    rest_speed: Vec3,
}

/// The state of a coat's hair from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Per coat and vertex.
    tips: Vec<Vec<Tip>>,
    seconds: f64,
}

impl Wind {
    /// How far it pushes hair of length 1 at a place and a time, in lengths.
    fn push(&self, at_m: Vec3, seconds: f64) -> Vec3 {
        if self.speed_m_per_s == 0.0 {
            return Vec3::ZERO;
        }
        let towards = self.towards.normalize_or_zero();
        let along_m = at_m.dot(towards);
        let wave = |(rate, share): (f32, f32)| {
            let turns = f64::from(along_m / self.gust_m) - seconds * f64::from(self.speed_m_per_s / self.gust_m);
            share * libm::sinf((turns * f64::from(rate)).fract() as f32 * std::f32::consts::TAU)
        };
        let swell: f32 = 1.0 + self.gusts.clamp(0.0, 1.0) * GUSTS.into_iter().map(wave).sum::<f32>();
        let speed = self.speed_m_per_s * swell / BENDING_M_PER_S;
        towards * (speed * speed)
    }
}

impl Motion {
    /// Lets `elapsed_s` pass over the coats of `scene` as they are posed now, and turns their offsets. Without wind and without
    /// anything that moves, they stay the bits that they are. Another number of coats or vertices begins anew.
    ///
    /// Each tip is a damped spring about where it rests, solved exactly over the step: it is stable, however long that is, and loses
    /// energy where nothing pushes it.
    pub fn step(&mut self, scene: &mut DrawList<'_>, wind: &Wind, spring: &Spring, elapsed_s: f32) {
        let elapsed_s = if elapsed_s.is_finite() { elapsed_s.max(0.0) } else { 0.0 };
        self.seconds += f64::from(elapsed_s);
        let same = |(tips, fur): (&Vec<Tip>, &CoatMesh<'_>)| tips.len() == fur.positions_m.len();
        if self.tips.len() != scene.furs.len() || !self.tips.iter().zip(&scene.furs).all(same) {
            let at_rest = |fur: &CoatMesh<'_>| {
                let rest = |(&p, &o): (&Vec3, &Vec3)| Tip { rest_m: p + o, ..Tip::default() };
                fur.positions_m.iter().zip(&fur.offsets_m).map(rest).collect()
            };
            self.tips = scene.furs.iter().map(at_rest).collect();
        }
        let passed = Passed::new(spring, elapsed_s);
        for (tips, fur) in self.tips.iter_mut().zip(&mut scene.furs) {
            for (v, tip) in tips.iter_mut().enumerate() {
                let (position_m, offset_m) = (fur.positions_m[v], fur.offsets_m[v]);
                let push = wind.push(position_m, self.seconds);
                fur.offsets_m[v] = tip.step(position_m, offset_m, push, &passed, elapsed_s);
            }
        }
    }

    /// Energy of all tips for a mass of 1 each, m²/s²: kinetic and that of the springs.
    pub fn energy(&self, spring: &Spring) -> f64 {
        let rate = f64::from(spring.frequency_hz) * std::f64::consts::TAU;
        let of =
            |tip: &Tip| f64::from(tip.speed.length_squared()) + rate * rate * f64::from(tip.away_m.length_squared());
        self.tips.iter().flatten().map(of).sum::<f64>() * 0.5
    }
}

/// What a step does to a damped spring: linear in where it is and how quickly it goes.
struct Passed {
    /// Of the place: what is left of it, and what speed adds to it.
    place: [f32; 2],
    /// Of the speed: what the place adds to it, and what is left of it.
    speed: [f32; 2],
    /// Time of a swing over 2π, s.
    period_s: f32,
}

impl Passed {
    /// The solution of x″ + 2ζω x′ + ω² x = 0 over `elapsed_s`, for ζ below 1.
    fn new(spring: &Spring, elapsed_s: f32) -> Self {
        let rate = f64::from(spring.frequency_hz.max(1e-3)) * std::f64::consts::TAU;
        let damping = f64::from(spring.damping.clamp(0.0, 0.999));
        let (decay, swing) = (damping * rate, rate * (1.0 - damping * damping).sqrt());
        let t = f64::from(elapsed_s);
        let left = libm::exp(-decay * t);
        let (sin, cos) = (libm::sin(swing * t), libm::cos(swing * t));
        let place = [left * (cos + decay / swing * sin), left * sin / swing];
        let speed = [-left * rate * rate / swing * sin, left * (cos - decay / swing * sin)];
        Self { place: place.map(|x| x as f32), speed: speed.map(|x| x as f32), period_s: (1.0 / rate) as f32 }
    }
}

impl Tip {
    /// Lets a step pass; the offset as it is turned then.
    fn step(&mut self, position_m: Vec3, offset_m: Vec3, push: Vec3, passed: &Passed, elapsed_s: f32) -> Vec3 {
        let length_m = offset_m.length();
        let along = offset_m.normalize_or_zero();
        let rest_m = position_m + offset_m;
        if elapsed_s > 0.0 {
            // The skin goes on as it went in this step: what its speed changed by is left behind.
            let rest_speed = (rest_m - self.rest_m) / elapsed_s;
            self.speed -= rest_speed - self.rest_speed;
            (self.rest_m, self.rest_speed) = (rest_m, rest_speed);
            // About where the push would hold it.
            let held_m = (push - along * push.dot(along)) * length_m;
            let from_m = self.away_m - held_m;
            self.away_m = held_m + from_m * passed.place[0] + self.speed * passed.place[1];
            self.speed = from_m * passed.speed[0] + self.speed * passed.speed[1];
        }
        // A hair does not grow: what lies along it is no swing.
        let across = |v: Vec3| v - along * v.dot(along);
        (self.away_m, self.speed) = (across(self.away_m), across(self.speed));
        let furthest_m = FURTHEST * length_m;
        if self.away_m.length_squared() > furthest_m * furthest_m {
            self.away_m = self.away_m.clamp_length_max(furthest_m);
            // It is stopped there.
            let outwards = self.away_m.normalize_or_zero();
            self.speed -= outwards * self.speed.dot(outwards).max(0.0);
        }
        if !(self.away_m.is_finite() && self.speed.is_finite()) {
            (self.away_m, self.speed) = (Vec3::ZERO, Vec3::ZERO);
        }
        let still_m = STILL * length_m;
        if push == Vec3::ZERO && self.away_m.length().max(self.speed.length() * passed.period_s) <= still_m {
            (self.away_m, self.speed) = (Vec3::ZERO, Vec3::ZERO);
            return offset_m;
        }
        (offset_m + self.away_m).normalize_or_zero() * length_m
    }
}
