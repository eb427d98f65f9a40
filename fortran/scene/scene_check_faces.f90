!> What the faces of a fracture do must agree: closure with the aperture, the parts of a bond with
!! each other and with friction, its toughness with that of the rock.
module scene_check_faces
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: fracture_t, scene_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_faces

   !> Of the aperture: less is lost among the iterates whose faces overlap (coarse_fracture_flow).
   real(rk), parameter :: largest_closure = 0.98_rk

contains

   !> All fractures of a scene.
   pure subroutine check_faces(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%fractures)
         call check_closure(sheet, sheet%find("fracture", i), scene%fractures(i), &
                            scene%has_fluid(), error)
         if (.not. allocated(error)) call check_bond(sheet, sheet%find("fracture", i), &
                                                     scene%fractures(i), error)
         if (allocated(error)) return
         if (scene%fractures(i)%toughness < huge(1.0_rk) .and. &
             .not. scene%material%toughness < huge(1.0_rk)) then
            call refuse(error, sheet, sheet%find("fracture", i), "toughness", &
                        "is given, but that of &material, which other tips have, is missing")
            return
         end if
      end do
   end subroutine check_faces

   !> What closes is there to close, and stays open enough to let fluid through.
   pure subroutine check_closure(sheet, record, fracture, has_fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(fracture_t), intent(in) :: fracture
      logical, intent(in) :: has_fluid
      type(error_t), allocatable, intent(out) :: error

      if (.not. fracture%normal_stiffness > 0.0_rk) return
      if (fracture%law == "open") then
         call refuse(error, sheet, record, "normal_stiffness", "is given, but the faces of the "// &
                     "law 'open' do not touch; give 'friction' or 'frictionless'")
      else if (fracture%held_closed) then
         call refuse(error, sheet, record, "normal_stiffness", "is given, but faces that are "// &
                     "held closed, held_closed = .true., cannot close further; leave one out")
      else if (has_fluid .and. fracture%closure > largest_closure*fracture%aperture) then
         call refuse(error, sheet, record, "closure", "is "//real_text(fracture%closure)// &
                     " m but must be at most "//real_text(largest_closure)//" of the "// &
                     "aperture, "//rounded_text(largest_closure*fracture%aperture)// &
                     " m, for some of it stays open under any stress")
      end if
   end subroutine check_closure

   !> A bond has a shear strength that slip takes away, and no more tension than that allows.
   pure subroutine check_bond(sheet, record, fracture, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(fracture_t), intent(in) :: fracture
      type(error_t), allocatable, intent(out) :: error

      if (fracture%cohesion > 0.0_rk .and. .not. fracture%weakening_slip > 0.0_rk) then
         call refuse(error, sheet, record, "cohesion", "is given, but weakening_slip, the slip "// &
                     "that breaks the bond, is missing")
      else if (fracture%tensile_strength > 0.0_rk .and. .not. fracture%cohesion > 0.0_rk) then
         call refuse(error, sheet, record, "tensile_strength", "is given, but cohesion, the "// &
                     "shear strength of the same bond, is missing")
      else if (fracture%tensile_strength*fracture%friction > fracture%cohesion) then
         call refuse(error, sheet, record, "tensile_strength", "is "// &
                     real_text(fracture%tensile_strength)//" Pa but must be at most "// &
                     "cohesion/friction, "// &
                     rounded_text(fracture%cohesion/fracture%friction)//" Pa, where the "// &
                     "shear strength is none")
      else if (fracture%cohesion > 0.0_rk .and. fracture%held_closed) then
         call refuse(error, sheet, record, "cohesion", "is given, but a bond of faces that are "// &
                     "held closed, held_closed = .true., never breaks; leave one out")
      end if
   end subroutine check_bond

end module scene_check_faces
