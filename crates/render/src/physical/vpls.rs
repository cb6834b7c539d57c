//! Station 3: virtual point lights where light paths meet diffuse surfaces (Keller 1997, "Instant Radiosity").

use super::emission::Origins;
use super::light_path::{Arrival, Deposits, trace_light};
use super::rejection::{Judged, Rejection};
use super::scene::Scene;
use lightcuts_kernel::bsdf::{DIFFUSE, PLASTIC, energy_at, lobes_of, mean_energy};
use lightcuts_kernel::virtual_light::{VirtualLight, pack_direction, virtual_table};
use std::f32::consts::PI;

/// Traces a fixed number of light paths for the virtual lights of a pass, and judges them. Once `is_over`, they are of
/// no use.
pub(crate) fn trace_vpls(
    scene: &Scene<'_>,
    origins: &Origins,
    rejection: Option<&Rejection>,
    paths: u32,
    stream: u32,
    is_over: &(dyn Fn() -> bool + Sync),
) -> Deposits<Judged> {
    let tables = &scene.world.tables[..];
    trace_light(
        scene,
        origins,
        paths,
        stream,
        |_, _| true,
        |arrival| {
            let light = virtual_light(arrival, tables)?;
            Some(match rejection {
                Some(rejection) => rejection.judge(scene, light, paths, arrival.random),
                None => Judged::kept(light),
            })
        },
        is_over,
    )
}

/// The virtual light of power that arrives; `None` if nothing is passed on evenly.
fn virtual_light(arrival: &Arrival<'_>, tables: &[f32]) -> Option<VirtualLight> {
    let Arrival { at, from, power, .. } = *arrival;
    let bsdf = &at.bsdf;
    if lobes_of(bsdf) & DIFFUSE == 0 {
        return None;
    }
    let coat = if bsdf.kind == PLASTIC {
        (1.0 - energy_at(tables, bsdf.table, false, at.wo.z.abs()))
            / (1.0 - mean_energy(tables, bsdf.table, false)).max(1e-4)
    } else {
        1.0
    };
    let ratio = at.normal.dot(from).abs() / at.face.dot(from).abs().max(1e-6);
    let intensity = power * bsdf.diffuse * (coat * ratio / PI);
    let side = 1.0_f32.copysign(at.face.dot(from));
    (intensity.is_finite() && intensity.max_element() > 0.0).then(|| VirtualLight {
        position: at.point + at.lift,
        table: virtual_table(bsdf),
        normal: at.face * side,
        shading: pack_direction(at.normal * side),
        intensity,
        is_bent: u32::from(at.normal != at.face),
    })
}
