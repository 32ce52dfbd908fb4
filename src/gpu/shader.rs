//! Shaders are WGSL files that import each other by name (naga_oil).

use super::Gpu;
use crate::error::{Error, Kind, Result};
use naga_oil::compose::{ComposableModuleDescriptor, Composer, NagaModuleDescriptor};
use std::borrow::Cow;
use wgpu::naga::valid::Capabilities;

/// One WGSL module.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Path below `shaders/`, for messages.
    pub path: &'static str,
    /// What it says.
    pub text: Text,
}

/// What a module says.
#[derive(Clone, Copy, Debug)]
pub enum Text {
    /// A file's text.
    Wgsl(&'static str),
    /// Constants that Rust and shaders both need, written once, in Rust: the module `furrier::` and the source's path.
    Constants(&'static [Constant]),
}

/// A named constant.
#[derive(Clone, Copy, Debug)]
pub enum Constant {
    /// Whole.
    U32(&'static str, u32),
    /// A number.
    F32(&'static str, f32),
    /// Several.
    F32s(&'static str, &'static [f32]),
}

impl Source {
    /// The module `furrier::NAME` of `constants`.
    pub const fn constants(name: &'static str, constants: &'static [Constant]) -> Self {
        Self { path: name, text: Text::Constants(constants) }
    }

    /// Its WGSL.
    pub fn wgsl(&self) -> Cow<'static, str> {
        match self.text {
            Text::Wgsl(text) => text.into(),
            Text::Constants(constants) => {
                let lines: String = constants.iter().map(Constant::wgsl).collect();
                format!("#define_import_path furrier::{}\n{lines}", self.path).into()
            }
        }
    }
}

impl Constant {
    fn wgsl(&self) -> String {
        match self {
            Self::U32(name, value) => format!("const {name}: u32 = {value}u;\n"),
            Self::F32(name, value) => format!("const {name}: f32 = {value:?};\n"),
            Self::F32s(name, values) => {
                let list = values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ");
                format!("const {name}: array<f32, {}> = array({list});\n", values.len())
            }
        }
    }
}

/// Modules that others import, read once for many.
pub struct Library {
    composer: Composer,
}

impl Library {
    /// Of `shared`, which must be given in order: imported before importing.
    ///
    /// # Errors
    /// [`Kind::Device`] with the file and the compiler's message.
    pub fn new(shared: &[Source]) -> Result<Self> {
        let capabilities = Capabilities::default() | Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        let mut composer = Composer::default().with_capabilities(capabilities);
        for source in shared {
            let text = source.wgsl();
            let described = ComposableModuleDescriptor { source: &text, file_path: source.path, ..Default::default() };
            if let Err(error) = composer.add_composable_module(described) {
                return Err(fault(source.path, &error.emit_to_string(&composer)));
            }
        }
        Ok(Self { composer })
    }

    /// The module of `main` with what it imports.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn compose(&mut self, main: Source) -> Result<wgpu::naga::Module> {
        let text = main.wgsl();
        let described = NagaModuleDescriptor { source: &text, file_path: main.path, ..Default::default() };
        let composed = self.composer.make_naga_module(described);
        composed.map_err(|error| fault(main.path, &error.emit_to_string(&self.composer)))
    }
}

/// The module of `main` with what it imports from `shared`, which must be given in order: imported before importing.
///
/// # Errors
/// [`Kind::Device`] with the file and the compiler's message.
pub fn compose(main: Source, shared: &[Source]) -> Result<wgpu::naga::Module> {
    Library::new(shared)?.compose(main)
}

fn fault(path: &str, message: &str) -> Error {
    Error::new(Kind::Device, "a shader does not compile").with_field(format!("shaders/{path}")).with_found(message)
}

impl Gpu {
    /// Compiles `main` for this device.
    ///
    /// # Errors
    /// As [`compose`].
    pub fn shader(&self, main: Source, shared: &[Source]) -> Result<wgpu::ShaderModule> {
        self.shader_of(&mut Library::new(shared)?, main)
    }

    /// The same, with files that were read before.
    ///
    /// # Errors
    /// As [`compose`].
    pub fn shader_of(&self, library: &mut Library, main: Source) -> Result<wgpu::ShaderModule> {
        let module = library.compose(main)?;
        Ok(self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(main.path),
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        }))
    }
}
