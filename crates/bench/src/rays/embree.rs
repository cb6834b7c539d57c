//! Embree 4, where the machine has it. Its library is opened when asked for, so that nothing here depends on it.

#![allow(unsafe_code)]

use anyhow::{Context as _, Result, bail, ensure};
use glam::Vec3;
use libloading::{Library, Symbol};
use lightcuts_kernel::ray::Ray;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::ptr::null_mut;

// Numbers of Embree's interface, version 4.
const TRIANGLES: c_int = 0;
const INDICES: c_int = 0;
const VERTICES: c_int = 1;
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;
const VERSION: c_int = 0;
const NONE: u32 = u32::MAX;

type Handle = *mut c_void;

/// `N` of Embree's rays, each with room for a hit; what follows the geometry is told of instances, with some to spare.
#[repr(C, align(32))]
struct RayHit<const N: usize> {
    origin: [[f32; N]; 3],
    t_near: [f32; N],
    direction: [[f32; N]; 3],
    time: [f32; N],
    /// Afterwards where the hit is; before everything where something hides the ray.
    t_far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    barycentric: [[f32; N]; 2],
    primitive: [u32; N],
    geometry: [u32; N],
    instance: [[u32; N]; 4],
}

impl<const N: usize> RayHit<N> {
    fn new(rays: &[Ray; N]) -> Self {
        let vectors = |of: fn(&Ray) -> Vec3| [0, 1, 2].map(|axis| rays.each_ref().map(|ray| of(ray)[axis]));
        Self {
            origin: vectors(|ray| ray.origin),
            t_near: rays.each_ref().map(|ray| ray.t_min),
            direction: vectors(|ray| ray.direction),
            time: [0.0; N],
            t_far: rays.each_ref().map(|ray| ray.t_max),
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            barycentric: [[0.0; N]; 2],
            primitive: [NONE; N],
            geometry: [NONE; N],
            instance: [[NONE; N]; 4],
        }
    }
}

type Trace1 = unsafe extern "C" fn(Handle, *mut RayHit<1>, *mut c_void);
type Trace8 = unsafe extern "C" fn(*const c_int, Handle, *mut RayHit<8>, *mut c_void);

/// A scene of Embree's that rays can be sent into.
pub(super) struct Embree {
    scene: Handle,
    device: Handle,
    intersect1: Trace1,
    occluded1: Trace1,
    intersect8: Trace8,
    occluded8: Trace8,
    library: &'static Library,
}

// SAFETY: Embree lets any number of threads trace rays in one scene; it is changed by nobody.
unsafe impl Sync for Embree {}

/// A function of the library. The type must be that of its declaration.
fn function<'a, T>(library: &'a Library, name: &str) -> Result<Symbol<'a, T>> {
    // SAFETY: types are those of Embree 4's headers; its version is checked before anything but a device is made.
    unsafe { library.get(name.as_bytes()) }.with_context(|| format!("the library has no {name}"))
}

impl Embree {
    /// Opens the library and builds a scene of triangles, for one thread.
    pub(super) fn open(path: &Path, triangles: &[[Vec3; 3]]) -> Result<Self> {
        // SAFETY: the file is what the user says is Embree; loading it runs its own start-up code only.
        let library = unsafe { Library::new(path) }.with_context(|| format!("cannot open {}", path.display()))?;
        // It has threads of its own, which need it to the end.
        let library: &'static Library = Box::leak(Box::new(library));
        let new_device: Symbol<'_, unsafe extern "C" fn(*const c_char) -> Handle> = function(library, "rtcNewDevice")?;
        let property: Symbol<'_, unsafe extern "C" fn(Handle, c_int) -> isize> =
            function(library, "rtcGetDeviceProperty")?;
        // SAFETY: called as declared.
        let (device, version) = unsafe {
            let device = new_device(c"threads=1".as_ptr());
            ensure!(!device.is_null(), "Embree makes no device");
            (device, property(device, VERSION))
        };
        if version / 10_000 != 4 {
            bail!("Embree 4 is needed, and this one's version is {}.{}", version / 10_000, version / 100 % 100);
        }
        let scene = build(library, device, triangles)?;
        Ok(Self {
            scene,
            device,
            intersect1: *function(library, "rtcIntersect1")?,
            occluded1: *function(library, "rtcOccluded1")?,
            intersect8: *function(library, "rtcIntersect8")?,
            occluded8: *function(library, "rtcOccluded8")?,
            library,
        })
    }

    /// Whether there is anything between a ray's ends.
    pub(super) fn is_hit(&self, ray: &Ray) -> bool {
        self.one(self.occluded1, ray) < 0.0
    }

    /// The parameter of the nearest hit.
    pub(super) fn nearest(&self, ray: &Ray) -> f32 {
        self.one(self.intersect1, ray)
    }

    /// [`Embree::is_hit`] of eight rays, as 1 or 0.
    pub(super) fn are_hits(&self, rays: &[Ray; 8]) -> [f32; 8] {
        self.eight(self.occluded8, rays).map(|end| f32::from(u8::from(end < 0.0)))
    }

    /// [`Embree::nearest`] of eight rays.
    pub(super) fn nearest_of_eight(&self, rays: &[Ray; 8]) -> [f32; 8] {
        self.eight(self.intersect8, rays)
    }

    fn one(&self, trace: Trace1, ray: &Ray) -> f32 {
        let mut ray = RayHit::new(&[*ray]);
        // SAFETY: the scene is complete, and the ray has room for a hit.
        unsafe { trace(self.scene, &raw mut ray, null_mut()) };
        ray.t_far[0]
    }

    fn eight(&self, trace: Trace8, rays: &[Ray; 8]) -> [f32; 8] {
        #[repr(align(32))]
        struct All([c_int; 8]);
        static ALL: All = All([-1; 8]);
        let mut rays = RayHit::new(rays);
        // SAFETY: as for one.
        unsafe { trace(ALL.0.as_ptr(), self.scene, &raw mut rays, null_mut()) };
        rays.t_far
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        for (name, handle) in [("rtcReleaseScene", self.scene), ("rtcReleaseDevice", self.device)] {
            if let Ok(release) = function::<unsafe extern "C" fn(Handle)>(self.library, name) {
                // SAFETY: nobody else has the handle.
                unsafe { release(handle) };
            }
        }
    }
}

/// A scene of triangles that share no corners, by Embree's usual builder.
fn build(library: &Library, device: Handle, triangles: &[[Vec3; 3]]) -> Result<Handle> {
    let new_scene: Symbol<'_, unsafe extern "C" fn(Handle) -> Handle> = function(library, "rtcNewScene")?;
    let new_geometry: Symbol<'_, unsafe extern "C" fn(Handle, c_int) -> Handle> = function(library, "rtcNewGeometry")?;
    let new_buffer: Symbol<'_, unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void> =
        function(library, "rtcSetNewGeometryBuffer")?;
    let commit_geometry: Symbol<'_, unsafe extern "C" fn(Handle)> = function(library, "rtcCommitGeometry")?;
    let attach: Symbol<'_, unsafe extern "C" fn(Handle, Handle) -> c_uint> = function(library, "rtcAttachGeometry")?;
    let release: Symbol<'_, unsafe extern "C" fn(Handle)> = function(library, "rtcReleaseGeometry")?;
    let commit: Symbol<'_, unsafe extern "C" fn(Handle)> = function(library, "rtcCommitScene")?;
    let count = triangles.len();
    // SAFETY: called as declared; Embree's buffers have as many elements as are asked for, or are null.
    unsafe {
        let (scene, geometry) = (new_scene(device), new_geometry(device, TRIANGLES));
        let vertices = new_buffer(geometry, VERTICES, 0, FLOAT3, size_of::<Vec3>(), count * 3).cast::<Vec3>();
        let indices = new_buffer(geometry, INDICES, 0, UINT3, size_of::<[u32; 3]>(), count).cast::<u32>();
        ensure!(!vertices.is_null() && !indices.is_null(), "Embree has no memory for {count} triangles");
        for (index, &corner) in triangles.as_flattened().iter().enumerate() {
            vertices.add(index).write_unaligned(corner);
            indices.add(index).write_unaligned(index as u32);
        }
        commit_geometry(geometry);
        attach(scene, geometry);
        release(geometry);
        commit(scene);
        Ok(scene)
    }
}
