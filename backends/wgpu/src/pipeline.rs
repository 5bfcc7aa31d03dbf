//! Shaders: assembled from modules, compiled once, kept by name.

use std::collections::HashMap;

use backend_api::{Access, Error, Kernel};
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType, ComputePipeline,
    ComputePipelineDescriptor, Device, PipelineCompilationOptions, PipelineLayoutDescriptor, ShaderModuleDescriptor,
    ShaderSource, ShaderStages,
};

use crate::scope;

const LAUNCH_STRUCT: &str = include_str!("../wgsl/launch.wgsl");

/// What stands before the modules of every kernel: `HcLaunch`, `hc_launch`, `hc_status`, `hc_raise`, `hc_item`.
///
/// ```
/// assert!(backend_wgpu::PRELUDE.contains("fn hc_item(gid: vec3<u32>, groups: vec3<u32>) -> u32"));
/// ```
pub const PRELUDE: &str = concat!(include_str!("../wgsl/launch.wgsl"), "\n", include_str!("../wgsl/prelude.wgsl"));

/// Binding numbers that all kernels share.
pub(crate) const LAUNCH_BINDING: u32 = 13;
pub(crate) const PARAMS_BINDING: u32 = 14;
pub(crate) const STATUS_BINDING: u32 = 15;

/// A shader and the buffers it works on.
#[derive(Clone, Copy)]
pub(crate) struct Program {
    pub(crate) name: &'static str,
    pub(crate) modules: &'static [&'static str],
    pub(crate) entry: &'static str,
    pub(crate) workgroup_size: u32,
    /// For each storage binding from 0 on, whether the shader writes it.
    pub(crate) writes: [Option<bool>; MAX_STORAGE],
    pub(crate) has_params: bool,
}

/// Storage bindings of a kernel, without the status words.
pub(crate) const MAX_STORAGE: usize = 5;

impl Program {
    /// The GPU's side of a kernel.
    pub(crate) fn of(kernel: &Kernel) -> Result<Self, Error> {
        let unsupported = Error::Unsupported { what: kernel.name };
        let wgsl = kernel.wgsl.filter(|_| !kernel.casts_rays).ok_or(unsupported)?;
        let mut writes = [None; MAX_STORAGE];
        if kernel.bindings.len() > MAX_STORAGE {
            return Err(unsupported);
        }
        for (place, decl) in writes.iter_mut().zip(kernel.bindings) {
            *place = Some(decl.access != Access::In);
        }
        Ok(Self {
            name: kernel.name,
            modules: wgsl.modules,
            entry: wgsl.entry,
            workgroup_size: wgsl.workgroup_size,
            writes,
            has_params: kernel.params_size > 0,
        })
    }

    fn layout_entries(&self) -> Vec<BindGroupLayoutEntry> {
        let storage = self.writes.iter().flatten().zip(0..);
        let mut entries: Vec<_> = storage
            .map(|(&writes, binding)| entry(binding, BufferBindingType::Storage { read_only: !writes }))
            .collect();
        entries.push(entry(LAUNCH_BINDING, BufferBindingType::Uniform));
        if self.has_params {
            entries.push(entry(PARAMS_BINDING, BufferBindingType::Uniform));
        }
        entries.push(entry(STATUS_BINDING, BufferBindingType::Storage { read_only: false }));
        entries
    }
}

fn entry(binding: u32, ty: BufferBindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

/// A compiled shader.
#[derive(Clone)]
pub(crate) struct Pipeline {
    pub(crate) compute: ComputePipeline,
    pub(crate) layout: BindGroupLayout,
    pub(crate) workgroup_size: u32,
}

/// Compiled shaders by name. One that the device refused stays refused.
#[derive(Default)]
pub(crate) struct Pipelines {
    by_name: HashMap<&'static str, Result<Pipeline, Error>>,
}

impl Pipelines {
    /// The program's pipeline; compiles it at the first call and then puts the device's words, if it refused, into
    /// `message`.
    pub(crate) fn get(&mut self, device: &Device, program: &Program, message: &mut String) -> Result<Pipeline, Error> {
        let made = self.by_name.entry(program.name).or_insert_with(|| {
            let source = assemble(PRELUDE, program.modules);
            let entries = program.layout_entries();
            compile(device, program.name, program.entry, program.workgroup_size, source, &entries).map_err(|text| {
                *message = text;
                Error::Shader { kernel: program.name }
            })
        });
        made.clone()
    }

    /// The pipeline that turns a count in a buffer into a launch.
    pub(crate) fn count(&mut self, device: &Device, message: &mut String) -> Result<Pipeline, Error> {
        let name = "backend.count";
        let made = self.by_name.entry(name).or_insert_with(|| {
            let entries = [
                entry(0, BufferBindingType::Storage { read_only: true }),
                entry(1, BufferBindingType::Storage { read_only: false }),
                entry(2, BufferBindingType::Storage { read_only: false }),
            ];
            let source = assemble(LAUNCH_STRUCT, &[include_str!("../wgsl/count.wgsl")]);
            compile(device, name, "hc_count_main", 1, source, &entries).map_err(|text| {
                *message = text;
                Error::Shader { kernel: name }
            })
        });
        made.clone()
    }
}

fn assemble(first: &str, modules: &[&str]) -> String {
    let mut source = String::from(first);
    for module in modules {
        source.push('\n');
        source.push_str(module);
    }
    source
}

fn compile(
    device: &Device,
    name: &'static str,
    entry_point: &'static str,
    workgroup_size: u32,
    source: String,
    entries: &[BindGroupLayoutEntry],
) -> Result<Pipeline, String> {
    let made = scope::catch(device, || {
        let module = device.create_shader_module(ShaderModuleDescriptor {
            label: Some(name),
            source: ShaderSource::Wgsl(source.into()),
        });
        let layout = device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some(name), entries });
        let pipeline_layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let compute = device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: PipelineCompilationOptions::default(),
            cache: None,
        });
        Pipeline { compute, layout, workgroup_size }
    });
    made.map_err(|fault| match fault {
        scope::Fault::OutOfMemory(text) | scope::Fault::Refused(text) => text,
    })
}
