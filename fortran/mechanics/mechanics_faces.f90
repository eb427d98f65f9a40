!> What holds on the fracture faces of the body: the law of each cell, and the slip that is given.
!!
!! New faces, which growth has made, have the law of their fracture; but next to a given slip, which
!! belongs to the fracture as it was at the start, they touch without friction, and they may part
!! though the fracture is held closed. A pressure on the faces acts on all of them.
module mechanics_faces
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_place
   use fine_faces, only: face_conditions_t, face_contact, loaded_everywhere
   use fine_mesh, only: fine_mesh_t
   use mesh_types, only: network_t
   use scene_types, only: fracture_t, scene_t
   use growth_network, only: fracture_length
   use simulation_laws, only: law_of_fracture
   implicit none(type, external)
   private

   public :: face_conditions, face_pressure, given_slip

contains

   !> The condition of every fracture cell.
   pure function face_conditions(scene, start, fine) result(conditions)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start  !< the scene's network
      type(fine_mesh_t), intent(in) :: fine
      type(face_conditions_t) :: conditions
      integer(ik) :: cell
      logical :: is_old

      conditions = loaded_everywhere(fine)
      do cell = 1, fine%fracture%n_cells
         associate (f => fine%fracture%cell_fracture(cell), law => conditions%law(cell))
            if (scene%fractures(f)%law == "open") cycle
            is_old = was_there(start, f, fine%fracture%cell_s(:, cell))
            law%contact = law_of_fracture(scene%fractures(f))
            if (.not. is_old) law%contact = law%contact%as_grown()
            law%contact%bilateral = scene%fractures(f)%held_closed .and. is_old
            law%slip_given = scene%fractures(f)%law == "slip" .and. is_old
            conditions%condition(cell) = face_contact
         end associate
      end do
   end function face_conditions

   !> The pressure on the faces of every fracture cell at load factor 1 [Pa].
   pure function face_pressure(scene, fine) result(pressure)
      type(scene_t), intent(in) :: scene
      type(fine_mesh_t), intent(in) :: fine
      real(rk) :: pressure(fine%fracture%n_cells)

      pressure = scene%fractures(fine%fracture%cell_fracture(:fine%fracture%n_cells))%face_pressure
   end function face_pressure

   !> A cell belongs to the fracture as it was at the start.
   pure logical function was_there(start, f, s)
      type(network_t), intent(in) :: start
      integer(ik), intent(in) :: f
      real(rk), intent(in) :: s(2)  !< arc length of the cell's ends [m]

      associate (length => fracture_length(start, f))
         was_there = minval(s) > -same_place*length .and. maxval(s) < (1.0_rk + same_place)*length
      end associate
   end function was_there

   !> The slip that the scene gives to the nodes of fracture cells at load factor 1, in `jump` (tau
   !! n, start end mid, fracture cell) [m].
   pure subroutine given_slip(scene, start, network, fine, jump)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< of the scene, and as it has grown
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(inout) :: jump(:, :, :)  !< (tau n, start end mid, fracture cells) [m]
      logical :: is_free(2)
      real(rk) :: length
      integer(ik) :: cell, f, k

      do cell = 1, fine%fracture%n_cells
         f = fine%fracture%cell_fracture(cell)
         if (scene%fractures(f)%law /= "slip") cycle
         length = fracture_length(start, f)
         if (.not. was_there(start, f, fine%fracture%cell_s(:, cell))) cycle
         is_free = [.not. network%s_start(f) < 0.0_rk, &
                    .not. fracture_length(network, f) + network%s_start(f) > &
                    (1.0_rk + same_place)*length]
         do k = 1, 3
            jump(1, k, cell) = tapered_slip(scene%fractures(f), length, is_free, &
                                            fine%face_s(k, cell))
         end do
      end do
      call turn_at_kinks(scene, start, fine, jump)
   end subroutine given_slip

   !> Where a given slip d leads into a wing, the node of both has the mean of their directions as
   !! its tangent (fine_faces): along it goes the part of d that points that way; what is across,
   !! the opening of the wing's mouth, is left to contact.
   pure subroutine turn_at_kinks(scene, start, fine, jump)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(inout) :: jump(:, :, :)  !< (tau n, start end mid, fracture cells) [m]
      real(rk) :: tangent(2), along
      integer(ik) :: cell

      do cell = 1, fine%fracture%n_cells - 1  ! cells are stored along each fracture
         associate (f => fine%fracture%cell_fracture, s => fine%fracture%cell_s)
            if (f(cell) /= f(cell + 1) .or. scene%fractures(f(cell))%law /= "slip") cycle
            if (was_there(start, f(cell), s(:, cell)) .eqv. &
                was_there(start, f(cell), s(:, cell + 1))) cycle
         end associate
         tangent = fine%face_tangent(:, cell) + fine%face_tangent(:, cell + 1)
         tangent = tangent/norm2(tangent)
         if (abs(jump(1, 2, cell)) > 0.0_rk) then  ! the slip is on this cell
            along = jump(1, 2, cell)*dot_product(tangent, fine%face_tangent(:, cell))
         else
            along = jump(1, 1, cell + 1)*dot_product(tangent, fine%face_tangent(:, cell + 1))
         end if
         jump(1, 2, cell) = along
         jump(1, 1, cell + 1) = along
      end do
   end subroutine turn_at_kinks

   !> The slip at an arc length for load factor 1 [m]. Next to an end from which nothing has grown
   !! it rises as a quarter of an ellipse; an end that leads into a wing slips like the middle.
   pure real(rk) function tapered_slip(fracture, length, is_free, s) result(slip)
      type(fracture_t), intent(in) :: fracture
      real(rk), intent(in) :: length  !< [m]
      logical, intent(in) :: is_free(2)  !< start, end
      real(rk), intent(in) :: s  !< [m]
      real(rk) :: inwards(2)
      integer :: i

      slip = fracture%slip
      inwards = max(0.0_rk, [s, length - s])/fracture%slip_taper
      do i = 1, 2
         if (.not. is_free(i) .or. inwards(i) >= 1.0_rk) cycle
         slip = slip*sqrt(inwards(i)*(2.0_rk - inwards(i)))
      end do
   end function tapered_slip

end module mechanics_faces
