//! What the oracle answers holds.

use std::f32::consts::FRAC_PI_4;

use cohabit_language::Oracle;
use proptest::prelude::*;

use crate::support::{catalog, scene};

/// Who goes less far need not have moved, m.
const STEP_M: f32 = 0.3;
/// So near a border between two directions rounding decides.
const BORDER: f32 = 0.01;

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_way_that_is_told_leads_there(
        yaw_rad in -7.0_f32..7.0,
        bearing_rad in -3.1_f32..3.1,
        away_m in 0.0_f32..20.0,
    ) {
        let sides = [FRAC_PI_4, 3.0 * FRAC_PI_4];
        prop_assume!(sides.iter().all(|side| (bearing_rad.abs() - side).abs() > BORDER));
        prop_assume!((away_m - STEP_M).abs() > BORDER);
        let catalog = catalog();
        let mut known = scene(&catalog, &[]);
        known.robot.yaw_rad = yaw_rad;
        let [x, y, _] = known.robot.position_m;
        let (sin, cos) = (yaw_rad + bearing_rad).sin_cos();
        let expected = match bearing_rad {
            _ if away_m < STEP_M => "You don't need to move.",
            bearing if bearing.abs() < sides[0] => "You should go straight ahead.",
            bearing if bearing.abs() > sides[1] => "You should turn around.",
            bearing if bearing > 0.0 => "You should turn left.",
            _ => "You should turn right.",
        };
        prop_assert_eq!(Oracle::new(&catalog, &known).way([x + away_m * cos, y + away_m * sin]), expected);
    }
}
