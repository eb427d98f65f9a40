!> Stress intensity factors of a free tip by three methods, and the differences between them.
module fine_tip_intensity
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, pi, rk
   use base_plane, only: cross, norm2, turned_left
   use base_tolerances, only: round_off, same_direction, same_value
   use fine_faces, only: face_contact
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_tip_domain, only: face_traction, largest_radius, rosette_size
   use fine_tip_energy, only: displacement_correlation, release_rate
   use fine_tip_interaction, only: interaction_integrals, tip_probe_t
   use fine_tip_types, only: complete_errors, frame_of_tip, intensity_t, tip_frame_t
   implicit none(type, external)
   private

   public :: intensity_of_tip, probe_of_tip, tip_intensity

   ! The larger domain has a radius of some rosettes where there is room for them, and takes up half
   ! of the room where the rosette is small. A domain that shrank with the rosette would look the
   ! same on every mesh, and so would its error.
   real(rk), parameter :: reach = 4.0_rk  !< least radius in rosettes
   real(rk), parameter :: share_of_room = 0.15_rk  !< least radius over the largest possible
   real(rk), parameter :: inner_share = 0.6_rk  !< smaller radius over larger one
   real(rk), parameter :: plateau = 0.3_rk  !< share of the radius within which the weight is 1

   real(rk), parameter :: least = 1.3e-4_rk  !< least error, relative [-]

   !> Above this ratio of Poisson elements around tips show a wrong normal traction, and friction
   !! follows it; by the mean beyond the domain, up to so many radii, it is judged.
   real(rk), parameter :: nearly_incompressible = 0.49_rk, judged_reach = 3.0_rk

contains

   !> What finds the intensities of a free tip of the model's mesh.
   subroutine probe_of_tip(model, tip, probe, error)
      type(fine_model_t), intent(in) :: model
      integer(ik), intent(in) :: tip  !< 1 .. fracture%n_tips
      type(tip_probe_t), intent(out) :: probe
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: room
      character(len=16) :: number

      if (tip < 1 .or. tip > model%mesh%fracture%n_tips) then
         write (number, "(i0)") tip
         call raise_error(error, "tip_intensity", "the window has no tip number "//trim(number))
         return
      end if
      probe%frame = frame_of_tip(model%mesh, model%rocks, tip)
      room = largest_radius(model%mesh, probe%frame, model%rocks)
      probe%radius = min(room, max(share_of_room*room, &
                                   reach*rosette_size(model%mesh, probe%frame)))
      probe%radius_inner = inner_share*probe%radius
      probe%interactions = interaction_integrals(model, probe%frame, &
                                                 [probe%radius, probe%radius_inner], plateau)
   end subroutine probe_of_tip

   !> Displacement correlation, the interaction integral on two domains, and the energy release
   !! rate.
   !!
   !! The estimated error of an intensity is the difference between the domains, plus that between
   !! the magnitude of both intensities and the one that the energy release rate gives, and a least
   !! one. These share
   !! the tractions on the faces, whose errors they do not see (take_given_slip).
   subroutine tip_intensity(model, loads, displacement, probe, intensity, error, quickly)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads  !< those of the solution
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_probe_t), intent(in) :: probe
      type(intensity_t), intent(out) :: intensity
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: quickly  !< K_I and K_II alone, without errors
      real(rk) :: k(2, 2), mismatch, of_energy, size_of_all
      logical :: is_complete

      is_complete = .true.
      if (present(quickly)) is_complete = .not. quickly
      associate (result => intensity, frame => probe%frame)
         result%radius = probe%radius
         result%radius_inner = probe%radius_inner
         call displacement_correlation(model%mesh, frame%rock, displacement, frame, &
                                       result%k1_dc, result%k2_dc)
         k = probe%interactions%intensities(model, loads, displacement)
         result%k1 = k(1, 1)
         result%k2 = k(2, 1)
         if (is_complete) then
            result%k1_inner = k(1, 2)
            result%k2_inner = k(2, 2)
            result%g_domain = release_rate(model, loads, displacement, frame, result%radius, &
                                           plateau)
            of_energy = sqrt(frame%rock%crack_modulus()*max(result%g_domain, 0.0_rk))
            mismatch = abs(hypot(result%k1, result%k2) - of_energy) &
                       + least*hypot(result%k1, result%k2)
            result%k1_error = abs(result%k1 - result%k1_inner) + mismatch
            result%k2_error = abs(result%k2 - result%k2_inner) + mismatch
         end if
         result%k1_corrected = result%k1
         result%k2_corrected = result%k2
         size_of_all = sum(abs([result%k1, result%k2, result%k1_inner, result%k2_inner, &
                                result%k1_dc, result%k2_dc, result%g_domain]))
         call respect_contact(model, displacement, frame, intensity)
         if (is_complete) then
            call doubt_friction(model, loads, displacement, probe, intensity)
            call doubt_joints(model, loads, displacement, probe, intensity)
            call add_element_error(model%mesh, displacement, frame, intensity)
         end if
         call complete_errors(frame%rock%crack_modulus(), intensity)
      end associate
      if (.not. size_of_all <= huge(1.0_rk)) then
         call raise_error(error, "tip_intensity", "an intensity is not a finite number")
      end if
   end subroutine tip_intensity

   !> The same for a tip by its number, with a probe that is used once.
   subroutine intensity_of_tip(model, loads, displacement, tip, intensity, error)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads  !< those of the solution
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: tip  !< 1 .. fracture%n_tips
      type(intensity_t), intent(out) :: intensity
      type(error_t), allocatable, intent(out) :: error
      type(tip_probe_t) :: probe

      call probe_of_tip(model, tip, probe, error)
      if (allocated(error)) return
      call tip_intensity(model, loads, displacement, probe, intensity, error)
   end subroutine intensity_of_tip

   !> Where the law of contact closes the faces next to the tip, their jump says more than any
   !! integral: [u]_n = tan(psi) |[u]_tau| leaves K_I = tan(psi) |K_II|, and no jump leaves neither.
   pure subroutine respect_contact(model, displacement, frame, intensity)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      type(intensity_t), intent(inout) :: intensity
      real(rk) :: jump(2, 3), opening(3), slip(3), largest
      integer(ik) :: k

      if (model%conditions%condition(frame%face) /= face_contact) return
      associate (plus => model%mesh%face_nodes(:, 1, frame%face), &
                 minus => model%mesh%face_nodes(:, 2, frame%face), &
                 law => model%conditions%law(frame%face)%contact)
         jump = frame%upper*matmul(frame%axes, displacement(:, minus) - displacement(:, plus))
         do k = 1, 3
            opening(k) = jump(2, k)
            slip(k) = abs(jump(1, k))
         end do
         largest = maxval(abs(jump))
         if (largest <= round_off*max(maxval(abs(displacement)), law%closure_at_rest)) then
            intensity%k1 = 0.0_rk
            intensity%k2 = 0.0_rk
            intensity%k1_inner = 0.0_rk
            intensity%k2_inner = 0.0_rk
            intensity%k1_corrected = 0.0_rk
            intensity%k2_corrected = 0.0_rk
            intensity%k1_error = 0.0_rk
            intensity%k2_error = 0.0_rk
            intensity%closed = .true.
            return
         end if
         if (model%conditions%law(frame%face)%slip_given) then
            call take_given_slip(jump(1, 3), jump(1, 3 - model%mesh%face_at_tip(frame%face)), &
                                 model%mesh%face_tip(frame%face) > 0, intensity)
         end if
         if (maxval(abs(opening - law%dilation*slip)) <= same_value*largest) then
            intensity%k1 = law%dilation*abs(intensity%k2)
            intensity%k1_corrected = intensity%k1
            intensity%k1_inner = law%dilation*abs(intensity%k2_inner)
            intensity%k1_error = law%dilation*intensity%k2_error
            intensity%closed = .true.
         end if
      end associate
   end subroutine respect_contact

   !> What K_II of faces that slide with friction may be off because the normal traction there is:
   !! the sum over the cells of mu |f_n - mean f_n|, with the weight sqrt(2/(pi r)) that a shear
   !! traction at the distance r from the tip has in K_II.
   pure subroutine doubt_friction(model, loads, displacement, probe, intensity)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_probe_t), intent(in) :: probe
      type(intensity_t), intent(inout) :: intensity
      real(rk), allocatable :: normal(:), r(:, :)
      logical, allocatable :: is_far(:)
      real(rk) :: doubt, traction(2)
      integer(ik) :: cell, end, n

      associate (fine => model%mesh, frame => probe%frame, rock => probe%frame%rock)
         if (rock%poisson <= nearly_incompressible .or. rock%plane_stress) return
         if (model%conditions%condition(frame%face) /= face_contact) return
         if (.not. abs(intensity%k2) > 0.0_rk) return  ! no slip, so no K_II
         associate (law => model%conditions%law(frame%face))
            if (law%slip_given .or. .not. law%contact%friction > 0.0_rk) return
            doubt = law%contact%friction*sqrt(2.0_rk/pi)
         end associate
         n = fine%fracture%n_cells
         allocate (normal(n), source=0.0_rk)
         allocate (r(2, n), source=huge(1.0_rk))
         do cell = 1, n
            if (fine%fracture%cell_fracture(cell) /= frame%fracture) cycle
            do end = 1, 2
               r(end, cell) = norm2(fine%xy(:, fine%face_nodes(end, 1, cell)) - frame%origin)
            end do
            if (minval(r(:, cell)) > judged_reach*probe%radius) cycle
            traction = face_traction(model, loads, displacement, cell)
            normal(cell) = dot_product(traction, turned_left(fine%face_tangent(:, cell)))
         end do
      end associate
      is_far = minval(r, dim=1) < judged_reach*probe%radius .and. maxval(r, dim=1) > probe%radius
      if (.not. any(is_far)) return
      normal = abs(normal - sum(normal, mask=is_far)/count(is_far))
      doubt = doubt*sum(normal*abs(2.0_rk*(sqrt(r(2, :)) - sqrt(r(1, :)))), &
                        mask=minval(r, dim=1) < judged_reach*probe%radius)
      intensity%k2_error = intensity%k2_error + doubt
      intensity%k1_error = intensity%k1_error &
                           + model%conditions%law(probe%frame%face)%contact%dilation*doubt
   end subroutine doubt_friction

   !> What K of joints that close may be off because elements are larger than the part of the joint
   !! next to the tip that bears its pressure at rest: a share of what the variation of the traction
   !! within elements has in K, and more where that is not small compared with K. By random joints
   !! against series (verification/normal_closure) and finer elements
   !! (verification/stated_errors_unseen).
   pure subroutine doubt_joints(model, loads, displacement, probe, intensity)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_probe_t), intent(in) :: probe
      type(intensity_t), intent(inout) :: intensity
      real(rk), parameter :: unresolved(2) = [0.3_rk, 1.5_rk]  !< that share, and what is added [-]
      real(rk) :: k(2, 2)

      if (size(probe%interactions%joint) == 0) return
      k = abs(probe%interactions%by_joints(model, loads, displacement))
      k = k*(unresolved(1) + unresolved(2)*k/max(hypot(intensity%k1, intensity%k2) + k, &
                                                 tiny(1.0_rk)))
      intensity%k1_error = intensity%k1_error + k(1, 1)
      intensity%k2_error = intensity%k2_error + k(2, 1)
   end subroutine doubt_joints

   !> What the elements along a fracture add to the errors of K of its tips: of closed ones that
   !! slide a share that falls with the number of elements, and what kinks do. Elements of the
   !! length h at a kink miss a share of the jump there, in proportion to the sine of its angle: K
   !! of a jump [u] over l at the distance d from the tip is E' [u] l/(4 sqrt(2 pi) d**1.5); l is in
   !! proportion to sqrt(h d). The factor is that of winged cracks (verification/winged_crack) and
   !! bent fractures drawn at random (verification/stated_errors_unseen).
   pure subroutine add_element_error(mesh, displacement, frame, intensity)
      type(fine_mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      type(intensity_t), intent(inout) :: intensity
      real(rk), parameter :: factor = 0.055_rk
      real(rk), parameter :: of_sliding = 0.02_rk  ! times (element over length)**1.5
      real(rk) :: added, length, sine
      integer(ik) :: i

      added = 0.0_rk
      associate (fracture => mesh%fracture)
         do i = 1, fracture%n_cells - 1
            if (any(fracture%cell_fracture([i, i + 1]) /= frame%fracture)) cycle
            if (fracture%cell_points(2, i) /= fracture%cell_points(1, i + 1)) cycle
            sine = abs(cross(mesh%face_tangent(:, i), mesh%face_tangent(:, i + 1)))
            if (.not. sine > same_direction) cycle
            added = added + sine*sqrt(minval(mesh%face_length([i, i + 1]))) &
                    *max(jump_of(i), jump_of(i + 1)) &
                    /norm2(fracture%point_xy(:, fracture%cell_points(2, i)) - frame%origin)
         end do
      end associate
      added = factor*frame%rock%crack_modulus()/(4.0_rk*sqrt(2.0_rk*pi))*added
      if (intensity%closed) then
         length = sum(mesh%face_length, mask=mesh%fracture%cell_fracture == frame%fracture)
         added = added + of_sliding*(mesh%face_length(frame%face)/length)**1.5_rk*abs(intensity%k2)
      else
         intensity%k1_error = intensity%k1_error + added
      end if
      intensity%k2_error = intensity%k2_error + added

   contains

      !> Jump in the middle of a face [m].
      pure real(rk) function jump_of(face)
         integer(ik), intent(in) :: face

         jump_of = norm2(displacement(:, mesh%face_nodes(3, 2, face)) &
                         - displacement(:, mesh%face_nodes(3, 1, face)))
      end function jump_of

   end subroutine add_element_error

   !> K_II where the slip up to the tip is given: what it says by itself, from displacement
   !! correlation. The integrals need the shear traction that this slip takes, whose error next to
   !! the tip is the same on any mesh, some 0.3 % of K_II (traction_source in fine_tip_domain).
   !!
   !! With [u] = A sqrt(r) (1 + b r + c r**2 ..), correlation removes b; the next term leaves about
   !! c h**2/4. As b h/4 is how far the inner node alone would be off, and c about b**2, four times
   !! its square is a safe estimate.
   pure subroutine take_given_slip(near, far, has_quarter_point, intensity)
      real(rk), intent(in) :: near, far  !< slip at the tip element's middle node and its end [m]
      logical, intent(in) :: has_quarter_point  !< the middle node is at h/4, else at h/2
      type(intensity_t), intent(inout) :: intensity
      real(rk) :: combined, alone

      if (has_quarter_point) then
         combined = 8.0_rk*near - far
         alone = 6.0_rk*near
      else
         combined = 2.0_rk*sqrt(2.0_rk)*near - far
         alone = sqrt(2.0_rk)*near
      end if
      if (.not. abs(combined) > 0.0_rk) return
      intensity%k2 = intensity%k2_dc
      intensity%k2_inner = intensity%k2_dc
      intensity%k2_corrected = intensity%k2_dc
      intensity%k2_error = 4.0_rk*(alone/combined - 1.0_rk)**2*abs(intensity%k2_dc)
   end subroutine take_given_slip

end module fine_tip_intensity
