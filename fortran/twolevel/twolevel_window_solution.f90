!> The solution of a window under the loads of the coarse level, and its intensities.
submodule(twolevel_window) twolevel_window_solution
   use contact_law, only: is_same
   use fine_contact, only: contact_t, transfer_contact
   use fine_faces, only: face_conditions_t, face_jump
   use fine_tip_intensity, only: tip_intensity
   use fine_tip_types, only: intensity_t
   use twolevel_held_faces, only: choose_held, hold_faces, release_faces
   implicit none(type, external)

   !> Error of K of a tip without focus, over the difference of two methods [-].
   real(rk), parameter :: without_focus = 2.0_rk

contains

   module procedure find_intensities
   integer(ik) :: i
   logical :: again

   associate (n => self%model%mesh%n_vertices)
      self%loads%pore_pressure(:n) = self%map%pressure(n, coarse, values%nodal(3, :), &
                                                       values%drained)
   end associate
   if (any(self%sides%of%changes())) call follow_sides(self, scene)
   self%loads%boundary_displacement = self%curved_edge(coarse, values%displacement, &
                                                       values%gradient)
   if (self%undrained) then
      self%loads%pore_pressure = scene%initial%pressure
      if (allocated(self%pressure_in_situ)) self%loads%pore_pressure = 0.0_rk
   end if
   if (.not. allocated(self%served)) call self%choose_tips(self%at > 0)
   if (.not. allocated(history%contact) .or. allocated(history%mesh)) then
      call remember_contact(self, state, history)
   end if
   associate (face_condition => scene%discretization%face_condition)
      call self%faces%load(self%model%mesh, face_condition, state, &
                           scene%fluid%vapour_pressure, self%loads, self%pressure_in_situ, &
                           values%viscous)
   end associate
   if (self%is_body .and. .not. allocated(self%made%held) .and. &
       scene%discretization%face_condition == "contact") then
      self%made%held = choose_held(self%model%mesh, self%faces, coarse, values%law, state, &
                                   history%contact%slip_before, tips)
   end if
   do
      call self%prepare_matrix(scene, values%law, error)
      if (allocated(error)) return
      if (allocated(self%made%held)) then
         call hold_faces(self%made%held, history%contact, self%model%conditions%law, self%loads)
      end if
      call self%model%solve(self%loads, self%displacement, error, history%contact)
      if (allocated(error)) return
      if (.not. allocated(self%made%held)) exit
      call release_faces(self%model, self%loads, self%displacement, coarse, self%faces, &
                         self%made%held, again)
      if (.not. again) exit
   end do
   call find_probes(self, error)
   if (allocated(error)) return
   do i = 1, size(self%serves, kind=ik)
      associate (tip => tips(self%serves(i)))
         if (.not. self%served(i)%is_evaluated) cycle
         call tip_intensity(self%model, self%loads, self%displacement, self%served(i)%probe, &
                            tip%found, error)
         if (allocated(error)) return
         ! Both methods see the same elements, which are twice as large as usual.
         if (self%is_body .and. .not. tip%has_focus) then
            tip%found%k1_error = without_focus*tip%found%k1_error
            tip%found%k2_error = without_focus*tip%found%k2_error
         end if
      end associate
   end do
   end procedure find_intensities

   module procedure prepare_matrix
   type(face_conditions_t) :: conditions

   conditions = self%faces%conditions(self%model%mesh, scene%discretization%face_condition, law)
   if (allocated(self%made%held)) then
      where (self%made%held) conditions%condition = face_jump
   end if
   if (same_conditions(self%model, conditions)) return
   call self%model%prepare(conditions, error, self%sides%held_edge(self%model%mesh))
   end procedure prepare_matrix

   !> Update the time-dependent values of the sides.
   pure subroutine follow_sides(self, scene)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene

      call self%sides%change(scene)
      self%loads%force = self%force_in_situ
      call self%sides%add_loads(self%model%mesh, self%loads%force)
   end subroutine follow_sides

   !> Compute the interaction integrals of the tips in question that are not known.
   subroutine find_probes(self, error)
      class(window_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i

      do i = 1, size(self%serves, kind=ik)
         associate (tip => self%served(i))
            if (tip%has_probe .or. .not. tip%is_evaluated) cycle
            call probe_of_tip(self%model, self%at(i), tip%probe, error)
            if (allocated(error)) return
            tip%has_probe = .true.
         end associate
      end do
   end subroutine find_probes

   module procedure curved_edge

   edge = self%map%curved_edge(self%model%mesh, coarse, displacement, gradient)
   call self%sides%take_given(self%model%mesh, edge)
   end procedure curved_edge

   module procedure intensities_with
   type(fine_loads_t) :: loads
   type(contact_t) :: contact
   type(intensity_t) :: result
   real(rk), allocatable :: displacement(:, :)
   integer(ik) :: i

   loads = self%loads
   if (present(edge)) loads%boundary_displacement = edge
   if (present(pressure)) then
      loads%pore_pressure(:self%model%mesh%n_vertices) = &
         pressure(self%map%coarse_cell(:self%model%mesh%n_vertices))
   end if
   contact = history%contact
   call self%model%solve(loads, displacement, error, contact)
   if (allocated(error)) return
   do i = 1, size(self%serves, kind=ik)
      associate (tip => self%serves(i))
         if (.not. self%served(i)%is_evaluated) cycle
         call tip_intensity(self%model, loads, displacement, self%served(i)%probe, result, &
                            error, quickly=.true.)
         if (allocated(error)) return
         k(:, tip) = [result%k1, result%k2]
      end associate
   end do
   end procedure intensities_with

   !> Set the contact on a new mesh: that of the previous mesh, and outside of it that of the coarse
   !! level.
   subroutine remember_contact(self, state, history)
      class(window_t), intent(in) :: self
      type(state_t), intent(in) :: state
      type(window_history_t), intent(inout) :: history
      type(contact_t) :: contact

      contact = self%faces%history(self%model%mesh, state)
      if (allocated(history%mesh)) then
         call transfer_contact(history%mesh, history%contact, self%model%mesh, contact)
         deallocate (history%mesh)
      end if
      history%contact = contact
   end subroutine remember_contact

   !> Whether the model's matrix is that of these conditions.
   pure function same_conditions(model, conditions) result(same)
      type(fine_model_t), intent(in) :: model
      type(face_conditions_t), intent(in) :: conditions
      logical :: same

      same = model%ready
      if (same) same = all(model%conditions%condition == conditions%condition)
      if (same) same = all(is_same(model%conditions%law%contact, conditions%law%contact))
   end function same_conditions

end submodule twolevel_window_solution
