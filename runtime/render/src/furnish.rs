//! A floor plan's own furniture, without a world: for pictures and measurements of plans.

use std::collections::BTreeMap;

use cohabit_cdf::catalog::Receptacle;
use cohabit_cdf::layout::Layout;
use cohabit_cdf::{Catalog, ClassId, Color, Fluid, StateFlag, StateFlags};

use crate::instance::{Instance, Look};

/// The plan's placements, as the catalogue knows them; what stands on an anchor takes the next free one.
#[must_use]
pub fn furnish(catalog: &Catalog, layout: &Layout) -> Vec<Instance> {
    let mut placed: BTreeMap<&str, ([f32; 3], f32, ClassId, usize)> = BTreeMap::new();
    let mut instances = Vec::new();
    for placement in &layout.placements {
        let Some(class) = catalog.class_of_instance(&placement.instance) else { continue };
        let mut at = placement.at_m;
        if let Some((origin, yaw, host, used)) = placement.on.as_deref().and_then(|on| placed.get_mut(on)) {
            if placement.anchor {
                let taken = *used;
                *used += 1;
                at = catalog.class(*host).receptacle.as_ref().and_then(|own| anchor(own, taken)).unwrap_or(at);
            }
            let (sin, cos) = libm::sincosf(*yaw);
            at = [origin[0] + at[0] * cos - at[1] * sin, origin[1] + at[0] * sin + at[1] * cos, origin[2] + at[2]];
        }
        let yaw = placement.yaw_deg.to_radians();
        let (half_sin, half_cos) = libm::sincosf(yaw * 0.5);
        placed.insert(&placement.instance, (at, yaw, class, 0));
        instances.push(Instance {
            id: u32::try_from(instances.len()).unwrap_or(u32::MAX) + 1,
            look: Look::Object(class),
            position_m: at,
            rotation: [0.0, 0.0, half_sin, half_cos],
            scale: placement.scale,
            flags: StateFlags::default().with(StateFlag::Powered),
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            room: placement.room,
            visible: true,
        });
    }
    instances
}

fn anchor(receptacle: &Receptacle, mut index: usize) -> Option<[f32; 3]> {
    for surface in &receptacle.surfaces {
        let [columns, rows] = surface.anchors.map(|count| count as usize);
        if index < columns * rows {
            let share = |i: usize, n: usize| (i as f32 + 0.5) / n as f32 - 0.5;
            let [x, y, z] = surface.center_m;
            let (i, j) = (index % columns, index / columns);
            return Some([x + surface.size_m[0] * share(i, columns), y + surface.size_m[1] * share(j, rows), z]);
        }
        index -= columns * rows;
    }
    None
}
