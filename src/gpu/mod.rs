//! Floor 2: a graphics device and what moves data to it and back. Knows nothing of fur.
//!
//! Shaders are composed by name (`shader`), textures and buffers made and read back (`memory`), passes timed (`timer`). A
//! device may be opened for a window (`surface`), or for none.

mod adapter;
mod compute;
pub mod light;
mod memory;
mod shader;
mod surface;
mod timer;

pub use adapter::{Adapter, AdapterKind, Choice, adapters, missing_adapter_hint};
pub use compute::{Binding, Kernel};
pub use memory::{Coding, ReadBack, TextureArray};
pub use shader::{Constant, Library, Source, Text, compose};
pub use surface::Screen;
pub use timer::Timer;

use crate::error::{Error, Kind, Result};
use std::sync::{Arc, Mutex, PoisonError};

/// An open device.
pub struct Gpu {
    /// Makes resources.
    pub device: wgpu::Device,
    /// Takes work.
    pub queue: wgpu::Queue,
    /// What it runs on.
    pub adapter: Adapter,
    /// The first complaint that no call returned: validation, memory, loss.
    fault: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the adapter that `choice` means, with all its limits and, where it has them, timestamps.
    ///
    /// # Errors
    /// [`Kind::Device`] where there is none (naming the package that brings one) or it will not open.
    pub fn open(choice: &Choice) -> Result<Self> {
        let (adapter, handle) = adapter::choose(&adapter::instance(), choice, None)?;
        Self::of(adapter, &handle)
    }

    fn of(adapter: Adapter, handle: &wgpu::Adapter) -> Result<Self> {
        tracing::debug!(%adapter, "graphics adapter");
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("furrier"),
            required_features: handle.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: handle.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(handle.request_device(&descriptor)).map_err(|error| {
            Error::new(Kind::Device, "the graphics adapter would not open")
                .with_found(format!("{adapter}: {error}"))
                .with_hint(
                    "choose another one: `furrier devices` lists them, the device gpu:NAME is the one of that name",
                )
        })?;
        let fault = Arc::new(Mutex::new(None));
        let keeper = Arc::clone(&fault);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            keeper.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| error.to_string());
        }));
        Ok(Self { device, queue, adapter, fault })
    }

    /// Submits `encoder` and waits until the device has done everything asked of it.
    ///
    /// # Errors
    /// [`Kind::Device`] with the first thing that went wrong since the last call.
    pub fn finish(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.queue.submit([encoder.finish()]);
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        let fault = self.fault.lock().unwrap_or_else(PoisonError::into_inner).take();
        match (fault, polled) {
            (None, Ok(_)) => Ok(()),
            (Some(fault), _) => Err(self.failed(fault)),
            (None, Err(error)) => Err(self.failed(error.to_string())),
        }
    }

    fn failed(&self, found: String) -> Error {
        Error::new(Kind::Device, "the graphics device failed")
            .with_field(self.adapter.to_string())
            .with_found(found)
            .with_hint("try a smaller picture, or another adapter: the device gpu:NAME is the one of that name")
    }

    /// An encoder to record into.
    pub fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }
}
