//! Functions of hot loops: plain arithmetic that gives the same bits everywhere and fits vector lanes.

/// [`exp`] for x ≤ 0.
#[inline]
pub fn exp_negative(x: f32) -> f32 {
    exp(x.min(0.0))
}

/// e^x within 3e-7 of the value; 0 below −87, and e^88 above 88.
///
/// Splits x·log₂e into a whole part, which goes into the exponent bits, and a rest in [−½, ½], whose power is a
/// Taylor polynomial of degree 6.
#[inline]
pub fn exp(x: f32) -> f32 {
    if x < -87.0 {
        return 0.0;
    }
    let x = x.min(88.0);
    let y = x * std::f32::consts::LOG2_E;
    // Adding and taking away 1.5·2²³ rounds to the nearest whole number.
    const ROUND: f32 = 12_582_912.0;
    let whole = (y + ROUND) - ROUND;
    let f = (y - whole) * std::f32::consts::LN_2;
    let power =
        1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    power * f32::from_bits(((whole as i32 + 127) << 23) as u32)
}
