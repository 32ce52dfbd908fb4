//! The stack against the same strands, ray cast.

use furrier::coat::fins::FinParameters;
use furrier::coat::judge::{Effort, Row, coverage_table};
use furrier::coat::shells::ShellParameters;
use furrier::coat::tile::{TileHair, TileRecipe, bake, leaning};
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Colour, Guard, Shape, Undercoat};
use furrier::math::Vec3;

const EFFORT: Effort = Effort { pixels: 128, supersampling: 3 };

fn recipe(lean_deg: f32) -> TileRecipe {
    TileRecipe {
        preset: "test".into(),
        shells: ShellParameters { tile_mm: 8.0, ..ShellParameters::default() },
        fins: FinParameters::default(),
        skin: Vec3::splat(0.5),
        lean_deg,
    }
}

fn hair(guard: bool, shape: Shape) -> TileHair {
    let fibre = |on: bool, mut fibre: Fibre| {
        fibre.density_per_m2 *= f32::from(u8::from(on));
        fibre
    };
    let colour = Colour::default();
    let guard_fibre = Fibre::guard(&Guard { shape, ..Guard::default() }, &colour, 1.0);
    let undercoat_fibre = Fibre::undercoat(&Undercoat { shape, ..Undercoat::default() }, &colour, 1.0);
    TileHair::grow(&fibre(guard, guard_fibre), &fibre(!guard, undercoat_fibre), 8e-3, 7)
}

fn table(guard: bool, shape: Shape, lean_deg: f32) -> Vec<Row> {
    let hair = hair(guard, shape);
    let start = std::time::Instant::now();
    let tile = bake(&hair, &recipe(lean_deg));
    println!("baked in {:.2} s", start.elapsed().as_secs_f64());
    println!("gains {:?} {:?}", tile.shells.gains[0], tile.shells.gains[3]);
    let rows = coverage_table(&hair, &tile, leaning(lean_deg), EFFORT);
    println!("guard {guard} lean {lean_deg} bend {}  ({:.2} s)", shape.bend_deg, start.elapsed().as_secs_f64());
    for r in &rows {
        println!(
            "{:4.0}° strands {:.3} stack {:+.3} constant {:+.3}  rmse {:.3} / {:.3}",
            r.theta_deg,
            r.strands,
            r.stack - r.strands,
            r.constant - r.strands,
            r.rmse,
            r.rmse_constant
        );
    }
    rows
}

fn holds(rows: &[Row]) {
    for r in rows {
        let bound = if r.theta_deg > 61.0 { 0.05 } else { 0.02 };
        assert!((r.stack - r.strands).abs() <= bound, "coverage at {}°: {r:?}", r.theta_deg);
        if r.theta_deg == 40.0 || r.theta_deg == 60.0 {
            assert!(r.rmse <= 0.5 * r.rmse_constant, "structure at {}°: {r:?}", r.theta_deg);
        }
    }
}

#[test]
fn upright_guard_hair_has_the_coverage_of_its_strands() {
    holds(&table(true, Shape::default(), 0.0));
}

#[test]
fn combed_guard_hair_has_the_coverage_of_its_strands() {
    holds(&table(true, Shape::default(), 35.0));
}

#[test]
fn curved_guard_hair_has_the_coverage_of_its_strands() {
    holds(&table(true, Shape { bend_deg: 50.0, ..Shape::default() }, 0.0));
}

#[test]
fn upright_undercoat_has_the_coverage_of_its_strands() {
    holds(&table(false, Shape::default(), 0.0));
}

#[test]
fn combed_undercoat_has_the_coverage_of_its_strands() {
    holds(&table(false, Shape::default(), 35.0));
}

#[test]
fn curved_undercoat_has_the_coverage_of_its_strands() {
    holds(&table(false, Shape { bend_deg: 50.0, ..Shape::default() }, 0.0));
}
