//! Answers for vertices that no cache answers.

use backend_api::{Access, BindingDecl, Kernel, Launch};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;

/// Answers each record by its own light, one sample: what a filter needs in place of a cache.
///
/// Bindings: records ([`VertexRecord`]), estimates ([`EstimateRecord`]). No parameters. Records that are not valid are
/// answered by no samples.
pub static ANSWER_TRACED: Kernel = Kernel {
    name: "pt.answer_traced",
    bindings: &[
        BindingDecl { name: "pt_records", access: Access::In, stride: size_of::<VertexRecord>() as u32 },
        BindingDecl { name: "pt_estimates", access: Access::OutPerItem, stride: size_of::<EstimateRecord>() as u32 },
    ],
    params_size: 0,
    body: answer_traced,
    wgsl: None,
    casts_rays: false,
};

fn answer_traced(launch: &mut Launch<'_>) {
    let estimates = launch.output::<EstimateRecord>(1);
    let records = &launch.input::<VertexRecord>(0)[launch.first as usize..][..launch.count as usize];
    for (estimate, record) in estimates.iter_mut().zip(records) {
        *estimate = EstimateRecord { direct: record.direct, further: record.further };
        estimate.direct[3] = f32::from(u8::from(record.is_valid()));
        estimate.further[3] = 0.0;
    }
}
