//! Every shader's formulas against the same ones in Rust, over random inputs; and that no function of a shader is left out.

pub mod coat;
pub mod hair;
pub mod law;
pub mod list;
pub mod look;
mod place;
pub mod reference;

use furrier::gpu::{Binding, Choice, Gpu, Library, Source};
use furrier::math::hash::Stream;
use furrier::math::{Vec2, Vec3, Vec4};
use std::collections::BTreeMap;

/// Inputs per formula.
pub const COUNT: usize = 2048;

/// Vectors of numbers in [0, 1), `per` for each input.
fn random(per: usize, seed: u64) -> Vec<Vec4> {
    let mut random = Stream::new(seed);
    (0..per * COUNT).map(|_| Vec4::new(random.unit(), random.unit(), random.unit(), random.unit())).collect()
}

/// What a kernel binds in one group.
type Group<'a> = (&'a [Binding], Vec<wgpu::Buffer>);

/// Runs `main` once per input with `groups`, and behind them one with `inputs` and the outputs: `per` vectors for each input, NaN
/// where it writes none.
fn on_device(
    gpu: &Gpu,
    shared: &[Source],
    main: Source,
    groups: &[Group<'_>],
    inputs: &[Vec4],
    per: usize,
) -> Vec<Vec4> {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let outputs = gpu.buffer("outputs", &vec![Vec4::NAN; per * COUNT], usage);
    let inputs = gpu.read_only("inputs", inputs).unwrap();
    let own_layout = gpu.layout("formulas", &[Binding::Read, Binding::Write]);
    let layouts: Vec<_> = groups.iter().map(|(bindings, _)| gpu.layout("scene", bindings)).collect();
    let module = gpu.shader_of(&mut Library::new(shared).unwrap(), main).unwrap();
    let all: Vec<_> = layouts.iter().chain([&own_layout]).collect();
    let kernel = gpu.kernel("formulas", &module, &all, &[]);
    let bound = |(layout, (_, buffers)): (&wgpu::BindGroupLayout, &Group<'_>)| {
        gpu.group(layout, &buffers.iter().collect::<Vec<_>>())
    };
    let mut bound: Vec<_> = layouts.iter().zip(groups).map(bound).collect();
    bound.push(gpu.group(&own_layout, &[&inputs, &outputs]));
    let read = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: outputs.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder("formulas");
    let bound: Vec<_> = bound.iter().collect();
    kernel.dispatch(&mut encoder.begin_compute_pass(&Default::default()), &bound, COUNT / 64);
    encoder.copy_buffer_to_buffer(&outputs, 0, &read, 0, outputs.size());
    gpu.finish(encoder).unwrap();
    bytemuck::pod_collect_to_vec(&gpu.read_buffer(&read).unwrap())
}

fn open() -> Gpu {
    Gpu::open(&Choice::Auto).unwrap()
}

/// A unit vector.
fn on_sphere(u: Vec2) -> Vec3 {
    let z = 2.0 * u.x - 1.0;
    let (r, (sin, cos)) = ((1.0 - z * z).max(0.0).sqrt(), (std::f32::consts::TAU * u.y).sin_cos());
    Vec3::new(r * cos, r * sin, z)
}

/// The largest difference of each formula, over 0.1 and what is expected.
#[derive(Default)]
pub struct Worst(BTreeMap<String, (f32, String)>);

impl Worst {
    /// Notes what a shader and Rust gave for input `i`.
    pub fn note(&mut self, i: usize, what: &str, got: f32, expected: f32) {
        let off = (got - expected).abs() / (0.1 + expected.abs());
        let entry = self.0.entry(what.to_owned()).or_default();
        if off.is_nan() || off >= entry.0 {
            *entry = (off, format!("input {i}: {got} by the shader, {expected} in Rust"));
        }
    }

    /// The same for each number of a vector.
    pub fn note_all(&mut self, i: usize, what: &str, got: Vec3, expected: Vec3) {
        (0..3).for_each(|k| self.note(i, what, got[k], expected[k]));
    }

    /// Prints what was found; gives formulas that are off by more than `most`, or that give what is not a number.
    pub fn faults(&self, most: f32) -> Vec<String> {
        self.0.iter().for_each(|(what, (off, said))| println!("{what}: {off:.1e}, {said}"));
        let off = self.0.iter().filter(|(_, (off, _))| off.is_nan() || *off > most);
        off.map(|(what, (off, said))| format!("{what} is off by {off:.1e}: {said}")).collect()
    }
}

fn hold(faults: Vec<String>) {
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
