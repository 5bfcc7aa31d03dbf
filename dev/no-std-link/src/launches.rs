//! `backend-api`: a kernel launched by hand, and the checks that backends share.

use core::hint::black_box;
use core::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use backend_api::check::{self, Limits};
use backend_api::{
    Access, Binding, BindingDecl, BufferDesc, BufferId, Error, Items, Kernel, Launch, Primitive, RayRecord, Slot,
    Status,
};

use crate::checks::Checks;
use crate::floor::Floor;

/// Adds its parameter to every input, counts the sum, and asks whether the floor is below.
static KERNEL: Kernel = Kernel {
    name: "link.add",
    bindings: &[
        BindingDecl { name: "input", access: Access::In, stride: 4 },
        BindingDecl { name: "output", access: Access::OutPerItem, stride: 4 },
        BindingDecl { name: "count", access: Access::AtomicU32, stride: 4 },
        BindingDecl { name: "sum", access: Access::AtomicU64, stride: 8 },
    ],
    params_size: 16,
    body: add,
    wgsl: None,
    casts_rays: true,
};

fn add(launch: &mut Launch<'_>) {
    let output = launch.output::<u32>(1);
    let term = launch.params::<[u32; 4]>()[0];
    let down = RayRecord { origin: [0.0, 1.0, 0.0], t_min: 0.0, direction: [0.0, -1.0, 0.0], t_max: 2.0 };
    for (i, to) in output.iter_mut().enumerate() {
        *to = launch.input::<u32>(0)[launch.first as usize + i] + term;
        launch.atomic_u64(3)[0].fetch_add(u64::from(*to), Relaxed);
        if launch.rays().trace_occluded(&down) && launch.rays().trace_closest(&down).triangle == 0 {
            launch.atomic_u32(2)[0].fetch_add(1, Relaxed);
        }
    }
    launch.raise(Status::OVERFLOW);
}

/// Calls everything and compares.
pub fn run(checks: &mut Checks) {
    launch(checks);
    arguments(checks);
}

fn launch(checks: &mut Checks) {
    let input = black_box([10_u32, 20, 30]);
    let mut output = [0_u32; 2];
    let (count, sum) = ([AtomicU32::new(0)], [AtomicU64::new(0)]);
    let status = AtomicU32::new(Status::NOT_RUN.bits());
    let mut slots = [
        Slot::In(bytemuck::cast_slice(&input)),
        Slot::Out(bytemuck::cast_slice_mut(&mut output)),
        Slot::AtomicU32(&count),
        Slot::AtomicU64(&sum),
    ];
    let params = [1_u32, 0, 0, 0];
    (KERNEL.body)(&mut Launch {
        first: 1,
        count: 2,
        params: bytemuck::bytes_of(&params),
        slots: &mut slots,
        status: &status,
        rays: Some(&Floor),
    });
    let raised = Status::from_bits(status.load(Relaxed));
    checks
        .that("Launch::raise", raised == Status::NOT_RUN.union(Status::OVERFLOW) && raised.contains(Status::OVERFLOW));
    checks.that("Launch::output", output == [21, 31]);
    checks.that("Launch::atomic", count[0].load(Relaxed) == 2 && sum[0].load(Relaxed) == 52);
}

fn arguments(checks: &mut Checks) {
    let buffer = |index| BufferId { index, generation: 0 };
    let bind = |index, size| Binding { buffer: buffer(index), offset: 0, size };
    let limits = Limits { max_binding_size: 1 << 20, has_geometry: true };
    let ask = |bindings: &[Binding]| {
        check::dispatch(&KERNEL, &[0; 16], bindings, Items::Count(2), &limits, |_| Some(black_box(64)))
    };
    checks.that("check::dispatch", ask(&[bind(0, 8), bind(1, 8), bind(2, 4), bind(3, 8)]).is_ok());
    checks.that("check::dispatch: few", matches!(ask(&[]), Err(Error::BindingCount { expected: 4, .. })));
    let twice = ask(&[bind(0, 8), bind(0, 8), bind(2, 4), bind(3, 8)]);
    checks.that("check::dispatch: aliased", matches!(twice, Err(Error::Aliased { binding: "output", .. })));
    checks.that("check::create", check::create(&BufferDesc { name: "odd", size: black_box(6) }, 1024).is_err());
    checks.that("check::transfer", check::transfer("dead", 0, 4, black_box(None)).is_err());
    let fill = Primitive::Fill { buffer: buffer(0), word: 1 };
    checks.that("check::primitive", check::primitive(&fill, &limits, |_| Some(black_box(64))).is_ok());
}
