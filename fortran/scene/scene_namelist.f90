!> Reading of a scene file.
module scene_namelist
   use base_errors, only: error_t
   use scene_check, only: check_scene, check_sheet
   use scene_defaults, only: resolve_defaults
   use scene_exchange, only: sheet_to_scene
   use scene_parse, only: parse_scene
   use scene_schedule, only: load_schedules
   use scene_sheet, only: sheet_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: read_scene

contains

   !> Read a scene, fill in its defaults and check it. On an error the scene is not to be used.
   !! Whether its geometry can be meshed is not for this room to judge.
   subroutine read_scene(path, scene, error, source)
      character(len=*), intent(in) :: path
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(sheet_t), intent(out), optional :: source  !< the file, for messages about its lines
      type(sheet_t) :: sheet

      call parse_scene(path, sheet, error)
      if (allocated(error)) return
      call load_schedules(sheet, error)
      if (allocated(error)) return
      call check_sheet(sheet, error)
      if (allocated(error)) return
      call sheet_to_scene(sheet, scene)
      call resolve_defaults(scene)
      call check_scene(sheet, scene, error)
      if (present(source)) source = sheet
   end subroutine read_scene

end module scene_namelist
