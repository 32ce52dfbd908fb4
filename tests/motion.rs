//! Hair that moves: it keeps its length at any frame rate, loses energy, and comes to rest where it was.

use furrier::math::{Vec2, Vec3, Vec4};
use furrier::runtime::{CoatMesh, DrawList, Motion, Spring, Wind};

/// A furred ball of radius 0.2 m with hair 40 mm long that leans, as latitudes and longitudes.
struct Ball {
    positions_m: Vec<Vec3>,
    offsets_m: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Ball {
    fn new() -> Self {
        let (rows, columns) = (24, 48);
        let (mut positions_m, mut offsets_m, mut triangles) = (vec![], vec![], vec![]);
        for row in 0..=rows {
            for column in 0..columns {
                let (polar, around) = (
                    std::f32::consts::PI * (row as f32 + 0.02) / (rows as f32 + 0.04),
                    std::f32::consts::TAU * column as f32 / columns as f32,
                );
                let normal = Vec3::new(polar.sin() * around.cos(), polar.cos(), polar.sin() * around.sin());
                positions_m.push(normal * 0.2);
                offsets_m.push((normal - Vec3::Y * 0.6 * polar.sin()).normalize() * 0.04);
                if row < rows {
                    let at = |row: u32, column: u32| row * columns + column % columns;
                    let (a, b) = (at(row, column), at(row, column + 1));
                    let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
                    triangles.extend([[a, c, b], [b, c, d]]);
                }
            }
        }
        Self { positions_m, offsets_m, triangles }
    }

    /// The ball turned about the vertical and moved.
    fn posed(&self, turned_rad: f32, moved_m: Vec3) -> DrawList<'_> {
        let turn = furrier::math::Quat::from_rotation_y(turned_rad);
        let count = self.positions_m.len();
        let fur = CoatMesh {
            positions_m: self.positions_m.iter().map(|&p| turn * p + moved_m).collect(),
            normals: self.positions_m.iter().map(|&p| turn * p.normalize()).collect(),
            offsets_m: self.offsets_m.iter().map(|&o| turn * o).collect(),
            uv: vec![Vec2::ZERO; count].into(),
            tint: vec![Vec4::ONE; count].into(),
            triangles: &self.triangles,
            ..CoatMesh::default()
        };
        DrawList { furs: vec![fur], ..DrawList::default() }
    }

    /// The largest change of a hair's length inside triangles, of its length at rest.
    fn stretch(&self, scene: &DrawList<'_>) -> f32 {
        let inside = [[1.0 / 3.0; 3], [0.6, 0.2, 0.2], [0.2, 0.6, 0.2], [0.2, 0.2, 0.6], [0.5, 0.5, 0.0]];
        let length = |offsets: &[Vec3], t: [u32; 3], at: [f32; 3]| {
            t.iter().zip(at).map(|(&v, w)| offsets[v as usize] * w).sum::<Vec3>().length()
        };
        let of = |&t: &[u32; 3]| {
            inside.map(|at| (length(&scene.furs[0].offsets_m, t, at) / length(&self.offsets_m, t, at) - 1.0).abs())
        };
        self.triangles.iter().flat_map(of).fold(0.0, f32::max)
    }
}

/// How the ball moves: it swings about and turns to and fro.
fn way(seconds: f32) -> (f32, Vec3) {
    (0.5 * (2.0 * seconds).sin(), Vec3::new(0.1 * (3.0 * seconds).sin(), 0.02 * (7.0 * seconds).cos(), 0.0))
}

#[test]
fn hair_keeps_its_length_in_wind_at_any_frame_rate() {
    let ball = Ball::new();
    let wind = Wind { towards: Vec3::new(1.0, 0.1, 0.4), speed_m_per_s: 7.0, gusts: 0.8, gust_m: 1.0 };
    for rate in [20, 60, 240] {
        let (mut motion, mut worst) = (Motion::default(), 0.0_f32);
        let mut furthest = 0.0_f32;
        for frame in 0..10 * rate {
            let (turned, moved) = way(frame as f32 / rate as f32);
            let mut scene = ball.posed(turned, moved);
            let still = scene.clone();
            motion.step(&mut scene, &wind, &Spring::default(), 1.0 / rate as f32);
            worst = worst.max(ball.stretch(&scene));
            let bent = scene.furs[0].offsets_m.iter().zip(&still.furs[0].offsets_m);
            furthest = bent.map(|(a, b)| a.angle_between(*b)).fold(furthest, f32::max);
        }
        println!(
            "{rate} Hz: length off by at most {:.2} %, bent by up to {:.0}°",
            100.0 * worst,
            furthest.to_degrees()
        );
        assert!(worst < 0.02, "{rate} Hz: {worst}");
        assert!(furthest > 0.3, "the wind bends it");
    }
}

#[test]
fn a_pause_leaves_numbers() {
    let ball = Ball::new();
    let wind = Wind { speed_m_per_s: 20.0, gusts: 1.0, ..Wind::default() };
    let mut motion = Motion::default();
    for elapsed_s in [0.016, 5.0, 0.016, 0.0, 5.0, 1e-6, f32::NAN, 0.016, 1e30] {
        let mut scene = ball.posed(0.3, Vec3::splat(elapsed_s.min(3.0)));
        motion.step(&mut scene, &wind, &Spring::default(), elapsed_s);
        assert!(scene.furs[0].offsets_m.iter().all(|o| o.is_finite()), "{elapsed_s}");
        // Each vertex's own hair is as long as it was, however far it is bent.
        assert!(scene.furs[0].offsets_m.iter().all(|o| (o.length() / 0.04 - 1.0).abs() < 1e-4), "{elapsed_s}");
    }
}

#[test]
fn without_a_push_it_loses_energy_and_comes_to_rest_as_it_was() {
    let ball = Ball::new();
    let (spring, none) = (Spring::default(), Wind::default());
    let gale = Wind { speed_m_per_s: 9.0, ..none };
    for elapsed_s in [1.0 / 240.0, 1.0 / 60.0, 1.0 / 20.0, 0.4] {
        let mut motion = Motion::default();
        for _ in 0..20 {
            motion.step(&mut ball.posed(0.0, Vec3::ZERO), &gale, &spring, elapsed_s);
        }
        let mut before = motion.energy(&spring);
        assert!(before > 0.0);
        for _ in 0..(8.0 / elapsed_s) as usize {
            motion.step(&mut ball.posed(0.0, Vec3::ZERO), &none, &spring, elapsed_s);
            let now = motion.energy(&spring);
            assert!(now < before || now == 0.0, "{elapsed_s}: {before} {now}");
            before = now;
        }
        assert_eq!(before, 0.0, "{elapsed_s}");
        let (still, mut scene) = (ball.posed(0.0, Vec3::ZERO), ball.posed(0.0, Vec3::ZERO));
        motion.step(&mut scene, &none, &spring, elapsed_s);
        assert_eq!(scene.furs[0].offsets_m, still.furs[0].offsets_m);
    }
}

#[test]
fn hair_lags_behind_a_skin_that_starts_and_goes_on_when_it_stops() {
    let ball = Ball::new();
    let mut motion = Motion::default();
    // The hair at the top, which stands up but for its lean.
    let mut lags = Vec::new();
    for frame in 0..40 {
        let x = if frame < 20 { 0.02 * frame as f32 } else { 0.38 };
        let moved = Vec3::X * x;
        let mut scene = ball.posed(0.0, moved);
        motion.step(&mut scene, &Wind::default(), &Spring::default(), 1.0 / 60.0);
        lags.push(scene.furs[0].offsets_m[0].x - ball.offsets_m[0].x);
    }
    assert!(lags[2] < -1e-3, "it is left behind: {}", lags[2]);
    assert!(lags[22] > 1e-3, "it goes on: {}", lags[22]);
}
