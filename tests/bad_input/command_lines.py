"""Cases about the command line: good meshes, and what is named here besides them. CASES[name](folder) writes it."""
import json
import pathlib

ASSET = (pathlib.Path(__file__).parent.parent / "golden" / "format_1_0.pliant").read_bytes()

# The good meshes alone.
NOTHING = """
    missing_file one_pose too_many_poses good output_folder_missing output_is_folder output_is_input output_is_device
    output_name_too_long output_is_dash unknown_option misspelt_option option_begun option_with_one_dash
    option_before_verb option_without_verb option_twice misspelt_verb verb_begun verb_version verb_completion
    bake_output_kind bake_stamp_kind bake_depfile_kind weights_not_numbers weights_by_name too_few_weights
    negative_weight range_without_zero range_too_far range_of_no_layer range_of_average range_unreadable
    range_decimal_comma layers_with_krylov placed_with_krylov many_poses_with_krylov grid_too_fine layer_grid_too_fine
    too_few_layer_weights infinite_layer_weight layers_without_shape list_without_grid
    average_path_one_name average_pattern not_an_asset tolerance_missed tolerance_unchecked two_ways_on
    time_limit_negative value_too_large value_not_a_number value_not_whole value_misspelt value_missing value_of_flag
    argument_missing output_missing argument_superfluous choice_of_plain_file idle_poisson idle_thickness memory_without_unit
    memory_unreadable memory_unit_alone memory_hexadecimal not_a_number not_a_number_seconds whole_negative whole_beyond
    whole_exponent
    """.split()

# An asset.
WITH_ASSET = """
    no_weights asset_without_options set_unknown set_misspelt set_without_equals set_twice set_decimal_comma
    set_joined blend_pattern blend_weight_count blend_output_kind export_path_missing export_no_asset
    export_over_asset export_folder_missing export_frame_rate export_morph_and_skin export_no_bones export_output_kind
    export_too_fine
    """.split()

# An asset and a list of weights, weights.csv.
WEIGHTS = {
    "no_frame_number": "1,1\n",
    "weights_file_damaged": "1,1\n1,x\n",
    "weights_with_semicolons": "1;1\n",
    "weights_of_spreadsheet": "\ufeff1,1\n1,x\n",
    "blend_path_negative": "1,1\r # 1\r-1,1\r",
    "blend_path_beyond_floats": "1,1\n1e39,0\n",
    "average_two_kinds": "1,1\n",
    "average_path_of_other_poses": "1,1\n1,2,3\n",
    "average_path_empty": "# nothing\n\n",
    "blend_path_empty": "",
    "export_path_without_animation": "1,1\n",
    "export_path_damaged": "1,1\n1,x\n",
    "export_path_count": "1,1\n1,1,1\n",
    "export_path_negative": "-1,2\n",
    "export_path_empty": "# nothing\n",
}

# One other file.
FILES = {
    "truncated_asset": ("cut.pliant", ASSET[:-1]),
    "damaged_asset": ("spoilt.pliant", ASSET[:-9] + b"\x55" + ASSET[-8:]),
    "empty_asset": ("empty.pliant", b""),
    "glb_without_asset": ("a.glb", b"glTF" + b"".join(n.to_bytes(4, "little") for n in (2, 20, 0)) + b"JSON"),
    "report_of_nothing": ("other.json", json.dumps({"seconds": {}}).encode()),
    "tolerance_missed_again": ("a.pliant", b"old"),
}


def writer(*files):
    def write(folder):
        for name, content in files:
            (folder / name).write_bytes(content)
    return write


CASES = {name: writer() for name in NOTHING}
CASES.update({name: writer(("asset.pliant", ASSET)) for name in WITH_ASSET})
CASES.update({name: writer(("asset.pliant", ASSET), ("weights.csv", text.encode())) for name, text in WEIGHTS.items()})
CASES.update({name: writer(file) for name, file in FILES.items()})
