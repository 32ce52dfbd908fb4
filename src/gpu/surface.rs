//! A device for a window: chosen among the adapters that can draw into it.

use super::{Choice, Gpu, adapter};
use crate::error::{Error, Kind, Result};

/// The part of a window that is drawn into.
pub struct Screen<'window> {
    /// Gives a texture for each picture.
    pub surface: wgpu::Surface<'window>,
    /// How it is best drawn into, its preferred format first of all. Width and height are the window's, to be set before the
    /// surface is configured with it.
    pub configuration: wgpu::SurfaceConfiguration,
}

impl Gpu {
    /// [`Self::open`], among the adapters that can present to the surface that `make` makes of a window.
    ///
    /// # Errors
    /// As [`Self::open`] and `make`; [`Kind::Device`] where no adapter can present to the surface.
    pub fn open_for_surface<'window>(
        choice: &Choice,
        make: impl FnOnce(&wgpu::Instance) -> Result<wgpu::Surface<'window>>,
    ) -> Result<(Self, Screen<'window>)> {
        let instance = adapter::instance();
        // Without any adapter no surface can be made: then that is what is missing.
        let surface =
            make(&instance).or_else(|error| adapter::choose(&instance, choice, None).and_then(|_| Err(error)))?;
        let (adapter, handle) = adapter::choose(&instance, choice, Some(&surface))?;
        let configuration = surface.get_default_config(&handle, 1, 1).ok_or_else(|| {
            Error::new(Kind::Device, "the window offers no format to draw in").with_found(adapter.to_string())
        })?;
        Ok((Self::of(adapter, &handle)?, Screen { surface, configuration }))
    }
}
