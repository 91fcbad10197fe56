/* SPDX-License-Identifier: BSD-3-Clause */
/** Options that several commands have, as entries of their tables, with their help. */
#ifndef VXM_CLI_OPTION_TABLES_H
#define VXM_CLI_OPTION_TABLES_H

/** For the tables of commands that make voxels; cli_engine_read takes their values. */
#define CLI_OPTIONS_ENGINE_METHODS                                                           \
  {CLI_KEY_DEVICE, "device", "N|NAME",                                                       \
   "the OpenCL device: its number in 'voxmend engines', or a part of its name or its\n"      \
   "platform's [a GPU, else the first]"},                                                    \
      {CLI_KEY_CL_METHOD, "cl-method", "auto|triangles|tiles",                               \
       "how OpenCL makes solids: triangles = each flips bits by itself; tiles = sorted by\n" \
       "tiles of columns; both have the bits of the cpu [auto]"},                            \
      {CLI_KEY_GL_METHOD, "gl-method", "columns|slices|tetra-vertex",                        \
       "how OpenGL makes solids: columns = a pass along an axis, the same bits as the\n"     \
       "cpu; slices, tetra-vertex = tetrahedra cut slice by slice, as published [columns]"}, \
  {                                                                                          \
    CLI_KEY_GL_AXIS, "gl-axis", "x|y|z", "across which axis slices are cut [y]"              \
  }
#define CLI_OPTIONS_ENGINE                                                              \
  {CLI_KEY_ENGINE, "engine", "E",                                                       \
   "who makes the voxels: cpu; opencl, opengl, or one that 'voxmend engines' lists;\n"  \
   "auto = a GPU by opencl or opengl, or else the cpu; several at once: opencl:all,\n"  \
   "or names joined by + [cpu]"},                                                       \
      CLI_OPTIONS_ENGINE_METHODS, {                                                     \
    CLI_KEY_GL_DISPLACE, "gl-displace", "D[,SEED]",                                     \
        "with slices: move each vertex at random by up to D voxels along each axis [0]" \
  }

/** What grids are written as, for help: the file, and the names of the formats. */
#define CLI_GRID_FILES                                                                    \
  "file to write: .binvox, .rle, .nrrd, .octree, .nii, .nii.gz, .vti, .vtk, .tif, .h5,\n" \
  ".vdb, .bt, .npy or .raw (the last three with a .json beside them), .vox, .schem or\n"  \
  ".litematic, .zarr (a folder), a picture for each slice (slice_%04d.png, with a\n"      \
  ".json), or the grid as a mesh: .obj, .ply, .stl, .off, .glb"
#define CLI_GRID_FORMATS                                                            \
  "binvox, npy, raw, rle, nrrd, vdb, octree, bt, nii, nii.gz, vti, vtk, tif, h5,\n" \
  "zarr, obj, ply, stl, off, glb, vox, schem, litematic or png [by the name of the output]"

/** For the tables of commands that make voxels of the numbers in a file; cli_threshold_read takes their
 * values. */
#define CLI_OPTIONS_THRESHOLD                                                              \
  {CLI_KEY_THRESHOLD, "threshold", "T",                                                    \
   "numbers in a file: voxels are set where the number is T or greater, such as\n"         \
   "0.5 of a coverage (128 where it is bytes) or 1 of labels"},                            \
  {                                                                                        \
    CLI_KEY_BELOW, "below", "T",                                                           \
        "voxels are set where the number is less than T, such as 0 of a signed distance\n" \
        "(-0 too); with --threshold, where both hold"                                      \
  }

/** For the tables of commands that read meshes; cli_next_option puts their values into cli->read. */
#define CLI_OPTIONS_READ                                                                 \
  {CLI_KEY_DEFLECTION, "deflection", "F",                                                \
   "STEP and IGES: how far triangles may lie from a curved surface, as a\n"              \
   "part of the model's diagonal [0.001]"},                                              \
  {                                                                                      \
    CLI_KEY_EXTERNAL, "external", "folder|any|none",                                     \
        "glTF and others: which files the mesh may refer to; folder = in its own\n"      \
        "folder or below, and none from standard input; any = wherever it says [folder]" \
  }

/** Those of grids that are written as meshes. */
#define CLI_OPTIONS_SURFACE(polygons, contacts)                                        \
  {polygons, "polygons", "split|keep",                                                 \
   "of a mesh: split = write triangles; keep = rectangles with further corners,\n"     \
   "in .obj, .ply and .off [split]"},                                                  \
  {                                                                                    \
    contacts, "no-manifold", NULL,                                                     \
        "of a mesh: leave voxels joined that touch in an edge or a corner alone, so\n" \
        "that edges may have four faces; else either side has vertices of its own,\n"  \
        "1/256 of a voxel within; where the numbers of the file, the 32-bit\n"         \
        "floats of .stl, are too coarse to tell vertices apart, there is no file"      \
  }
/** How blocks and meshes stand: of cli_style. */
#define CLI_OPTIONS_STYLE(blocks, up)                                                         \
  {blocks, "blocks", "NAME[,NAME...]",                                                        \
   "of .schem and .litematic: Minecraft's block for voxels, those for labels in\n"            \
   "turn, or those that colours choose from [stone; concrete, wool and terracotta in\n"       \
   "16 dyes; 83 plain cubes]"},                                                               \
  {                                                                                           \
    up, "up", "x|y|z", "of .schem, .litematic and .glb: axis of the model that points up [z]" \
  }
#define CLI_OPTION_FORCE(key) \
  { key, "force", NULL, "replace a mesh that is there" }

#endif
