//! The renderer for machines with a GPU: the pictures of [`cohabit_render`], drawn by wgpu.
