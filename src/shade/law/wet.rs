//! The look of wet hair: that of the dry hair, for a colour whose logit is less by a constant. Both polynomials that colours go through
//! stay what they are, with other factors, so that nothing that reads a look need know of water.

use super::colour::Colouring;
use super::known::Scattering;
use super::polynomial::COLOUR_TERMS;
use crate::shade::fibre::{Fibre, FibreModel, FibreParameters, Film};

/// The factors of P(x + `by`), P having the factors `of`.
fn shifted<const N: usize>(of: &[f32; N], by: f64) -> [f32; N] {
    // Horner's scheme: multiply by (x + by), add the next factor.
    let mut sum = [0.0_f64; N];
    for &factor in of.iter().rev() {
        for power in (0..N).rev() {
            let lower = if power > 0 { sum[power - 1] } else { f64::from(factor) };
            sum[power] = sum[power] * by + lower;
        }
    }
    sum.map(|x| x as f32)
}

impl Colouring {
    /// That of hair whose colours' logits are drawn down by `shift`.
    ///
    /// With k = e^shift, C becomes C/(k(1 − C) + C): a Möbius map, which takes (C − C₀)/(C₁ − C) to a multiple of the same with other ends.
    fn drawn_down(&self, shift: f64) -> Self {
        let k = libm::exp(shift);
        let end = |end: f32| (1.0 - f64::from(end)) + f64::from(end) * k;
        let raised = |c: f32| (f64::from(c) * k / end(c)) as f32;
        let by = libm::log(end(self.darkest) / end(self.lightest));
        Self { darkest: raised(self.darkest), lightest: raised(self.lightest), factors: shifted(&self.factors, by) }
    }
}

impl Scattering {
    /// This hair under a film of water.
    ///
    /// The law of what was scattered more than once is the dry hair's: it hangs on how much light each lobe sends on, and hardly on how
    /// sharply (measured in `docs/steps/shade.md`).
    pub fn wet(&self, film: &Film, model: FibreModel, dry: &FibreParameters) -> Self {
        if film.amount == 0.0 {
            return *self;
        }
        let shift = film.logit_shift();
        let mut law = self.law;
        let cubics = law.light.iter_mut().chain(&mut law.sky);
        cubics.for_each(|cubic: &mut [f32; COLOUR_TERMS]| *cubic = shifted(cubic, -shift));
        Self { fibre: Fibre::new(model, &film.smoothed(dry)), colouring: self.colouring.drawn_down(shift), law }
    }
}
