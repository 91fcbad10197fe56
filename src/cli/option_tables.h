/* SPDX-License-Identifier: BSD-3-Clause */
/** How tables of options say where a value goes, and options that several commands have, with their help. */
#ifndef VXM_CLI_OPTION_TABLES_H
#define VXM_CLI_OPTION_TABLES_H

#include <float.h>
#include <stddef.h>

/* ---- Targets: a member of the struct `type`, which the command hands to cli_read_options ---- */

/** Read by a function of the command, with more about it behind, such as .min and .max. */
#define CLI_VALUE(reader, type, member, ...) \
  { .read = reader, .at = offsetof(type, member), .size = sizeof((type *)NULL)->member, __VA_ARGS__ }
/** The function gets the whole request. */
#define CLI_VALUES(reader) \
  { .read = reader }
#define CLI_FLAG(type, member) CLI_VALUE(cli_take_flag, type, member)
#define CLI_TEXT(type, member) CLI_VALUE(cli_take_text, type, member)
#define CLI_SIZE(type, member) CLI_VALUE(cli_take_size, type, member)
#define CLI_NUMBER(type, member, low, high) CLI_VALUE(cli_take_number, type, member, .min = low, .max = high)
/** A double; `meant` says what another value is not, such as "a number from 0 to 1". */
#define CLI_REAL(type, member, from, to, meant) \
  CLI_VALUE(cli_take_real, type, member, .low = from, .high = to, .what = meant)
/** The least double above 0, and the greatest below 1. */
#define CLI_ABOVE_0 DBL_TRUE_MIN
#define CLI_BELOW_1 (1 - DBL_EPSILON / 2)
/** The first of the words stands for 0. */
#define CLI_CHOICE(type, member, words) CLI_VALUE(cli_take_choice, type, member, .choices = words)
#define CLI_CHOICE_FROM(first, type, member, words) \
  CLI_VALUE(cli_take_choice, type, member, .choices = words, .min = first)
/** A member of cli_run. */
#define CLI_RUN_VALUE(reader, member, ...) CLI_VALUE(reader, cli_run, member, .is_of_run = true, __VA_ARGS__)
/** Nowhere: cli_is_given is asked. */
#define CLI_NOTED \
  { .read = NULL }
#define CLI_OPTIONS_END \
  { .name = NULL }

/* ---- Options ---- */

/** For the tables of commands that make voxels, whose requests have a cli_engine `engine`. */
#define CLI_OPTIONS_ENGINE_METHODS(type)                                                     \
  {0, "device", "N|NAME",                                                                    \
   "the OpenCL device: its number in 'voxmend engines', or a part of its name or its\n"      \
   "platform's [a GPU, else the first]",                                                     \
   CLI_TEXT(type, engine.options.device)},                                                   \
      {0, "cl-method", "auto|triangles|tiles",                                               \
       "how OpenCL makes solids: triangles = each flips bits by itself; tiles = sorted by\n" \
       "tiles of columns; both have the bits of the cpu [auto]",                             \
       CLI_CHOICE(type, engine.options.cl_method, cli_cl_methods)},                          \
      {0, "gl-method", "columns|slices|tetra-vertex",                                        \
       "how OpenGL makes solids: columns = a pass along an axis, the same bits as the\n"     \
       "cpu; slices, tetra-vertex = tetrahedra cut slice by slice, as published [columns]",  \
       CLI_CHOICE(type, engine.options.gl_method, cli_gl_methods)},                          \
  {                                                                                          \
    0, "gl-axis", "x|y|z", "across which axis slices are cut [y]",                           \
        CLI_CHOICE(type, engine.options.slice_axis, cli_axes)                                \
  }
#define CLI_OPTIONS_ENGINE(type)                                                         \
  {0, "engine", "E",                                                                     \
   "who makes the voxels: cpu; opencl, opengl, or one that 'voxmend engines' lists;\n"   \
   "auto = a GPU by opencl or opengl, or else the cpu; several at once: opencl:all,\n"   \
   "or names joined by + [cpu]",                                                         \
   CLI_TEXT(type, engine.name)},                                                         \
      CLI_OPTIONS_ENGINE_METHODS(type), {                                                \
    0, "gl-displace", "D[,SEED]",                                                        \
        "with slices: move each vertex at random by up to D voxels along each axis [0]", \
        CLI_VALUE(cli_take_displacement, type, engine.options)                           \
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

/** For commands that make voxels of the numbers in a file, into a vxm_threshold_options `threshold`. */
#define CLI_OPTIONS_THRESHOLD(type)                                                        \
  {0, "threshold", "T",                                                                    \
   "numbers in a file: voxels are set where the number is T or greater, such as\n"         \
   "0.5 of a coverage (128 where it is bytes) or 1 of labels",                             \
   CLI_VALUE(cli_take_threshold, type, threshold)},                                        \
  {                                                                                        \
    0, "below", "T",                                                                       \
        "voxels are set where the number is less than T, such as 0 of a signed distance\n" \
        "(-0 too); with --threshold, where both hold",                                     \
        CLI_VALUE(cli_take_threshold, type, threshold)                                     \
  }

/** For commands that read meshes: they go into cli->read. */
#define CLI_OPTIONS_READ                                                                  \
  {0, "deflection", "F",                                                                  \
   "STEP and IGES: how far triangles may lie from a curved surface, as a\n"               \
   "part of the model's diagonal [0.001]",                                                \
   CLI_RUN_VALUE(cli_take_real, read.deflection, .low = CLI_ABOVE_0, .high = 1,           \
                 .what = "a number above 0 and up to 1")},                                \
  {                                                                                       \
    0, "external", "folder|any|none",                                                     \
        "glTF and others: which files the mesh may refer to; folder = in its own\n"       \
        "folder or below, and none from standard input; any = wherever it says [folder]", \
        CLI_RUN_VALUE(cli_take_choice, read.external, .choices = cli_external_files)      \
  }

/** Those of grids that are written as meshes, into a vxm_grid_write_options `write`. */
#define CLI_OPTIONS_SURFACE(type)                                                      \
  {0, "polygons", "split|keep",                                                        \
   "of a mesh: split = write triangles; keep = rectangles with further corners,\n"     \
   "in .obj, .ply and .off [split]",                                                   \
   CLI_CHOICE(type, write.keep_polygons, cli_polygon_kinds)},                          \
  {                                                                                    \
    0, "no-manifold", NULL,                                                            \
        "of a mesh: leave voxels joined that touch in an edge or a corner alone, so\n" \
        "that edges may have four faces; else either side has vertices of its own,\n"  \
        "1/256 of a voxel within; where the numbers of the file, the 32-bit\n"         \
        "floats of .stl, are too coarse to tell vertices apart, there is no file",     \
        CLI_FLAG(type, write.keep_contacts)                                            \
  }
/** How blocks and meshes stand, likewise. */
#define CLI_OPTIONS_STYLE(type)                                                               \
  {0, "blocks", "NAME[,NAME...]",                                                             \
   "of .schem and .litematic: Minecraft's block for voxels, those for labels in\n"            \
   "turn, or those that colours choose from [stone; concrete, wool and terracotta in\n"       \
   "16 dyes; 83 plain cubes]",                                                                \
   CLI_TEXT(type, write.blocks)},                                                             \
  {                                                                                           \
    0, "up", "x|y|z", "of .schem, .litematic and .glb: axis of the model that points up [z]", \
        CLI_CHOICE_FROM(1, type, write.up, cli_axes)                                          \
  }
#define CLI_OPTION_FORCE \
  { 0, "force", NULL, "replace a mesh that is there", CLI_NOTED }

#endif
